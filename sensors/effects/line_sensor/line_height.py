"""A line sensor that is mounted higher or lower than specified."""

from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from symolo.core.arrays import Array


class LineHeight(Effect):
    """The line sensor is mounted higher or lower than its description states."""

    slot = Slot.LINE_HEIGHT
    cause = "a bent bracket, a worn caster"
    excitation = "the edges of the line, and the level of the bare floor"
    setups = (Setup.LINE_LOG,)

    height_scale: Annotated[float, Parameter("1", null=1.0, start=1.3, low=0.3, high=4.0)]
    """Height above the floor * scale. The spots grow with it, and the light falls as its inverse square."""

    def apply(self, ratio: float | Array) -> float | Array:
        return self.height_scale * ratio

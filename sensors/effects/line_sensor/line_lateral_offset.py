"""A line sensor that is mounted off the middle."""

from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from symolo.core.arrays import Array


class LineLateralOffset(Effect):
    """All channels of the line sensor are displaced sideways by the same distance."""

    slot = Slot.LINE_PLACE
    cause = "a board that is screwed on askew"
    excitation = "the edges of the line"
    setups = (Setup.LINE_LOG,)

    offset_m: Annotated[float, Parameter("m", null=0.0, start=0.003, low=-0.05, high=0.05)]
    """Distance by which the row of channels sits further left."""

    def apply(self, place_m: Array) -> Array:
        return place_m + self.offset_m

"""Ambient light on all channels of the line sensor."""

from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from symolo.core.arrays import Array


class LineAmbient(Effect):
    """Ambient light adds the same amount to the readings of all channels."""

    slot = Slot.LINE_READING
    cause = "sunlight or lamps in the near infrared"
    excitation = "line and bare floor"
    setups = (Setup.LINE_LOG,)

    offset: Annotated[float, Parameter("1", null=0.0, start=0.05, low=-0.5, high=0.5)]
    """Reading of every channel + offset; 1 is full scale."""

    def apply(self, reading: Array) -> Array:
        return reading + self.offset

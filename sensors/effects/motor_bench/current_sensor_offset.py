"""A current sensor that does not read zero when no current flows."""

from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from symolo.core.arrays import Array


class CurrentSensorOffset(Effect):
    """The measured current is the true current plus a constant."""

    slot = Slot.CURRENT_READING
    cause = "offset of amplifier or converter"
    excitation = "rest at 0 V, and currents of both signs"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    offset_A: Annotated[float, Parameter("A", null=0.0, start=0.03, low=-20.0, high=20.0)]
    """measured = true + offset."""

    def apply(self, current_A: Array) -> Array:
        return current_A + self.offset_A

"""A current sensor whose gain is not nominal."""

from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Plausible, Scale
from symolo.core.arrays import Array


class CurrentSensorGain(Effect):
    """The measured current is a multiple of the true current."""

    slot = Slot.CURRENT_READING
    cause = "tolerance of shunt and amplifier"
    excitation = "a wide range of currents and the speed; without the speed, it looks like resistance and friction"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    gain: Annotated[Scale, Plausible(0.5, 2.0, "a shunt of the next value in a series of three values per decade")]
    """measured = gain * true."""

    def apply(self, current_A: Array) -> Array:
        return self.gain * current_A

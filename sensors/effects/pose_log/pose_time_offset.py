"""Poses that are logged late."""

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Delay
from symolo.core.arrays import Array


class PoseTimeOffset(Effect):
    """The logged pose is old by a constant time."""

    slot = Slot.POSE_DELAY
    cause = "exposure, transmission and clock of the external camera"
    excitation = "fast turns and starts, compared with the encoders"
    setups = (Setup.DRIVE,)

    delay_s: Delay
    """Age of the logged pose."""

    def apply(self, delay_s: float | Array, time_s: float | Array) -> float | Array:
        del time_s
        return delay_s + self.delay_s

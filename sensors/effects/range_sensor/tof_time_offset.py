"""Ranges that are logged late."""

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Delay


class TofTimeOffset(Effect):
    """The ranges in the log are old by a constant time."""

    slot = Slot.RANGE_DELAY
    cause = "timing budget and buffering of the sensor"
    excitation = "fast motion towards and past walls"
    setups = (Setup.DRIVE,)

    delay_s: Delay
    """Age of the logged ranges."""

    def apply(self, delay_s: float) -> float:
        return delay_s + self.delay_s

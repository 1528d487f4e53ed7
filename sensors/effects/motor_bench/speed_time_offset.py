"""A speed that is logged late."""

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Delay


class SpeedTimeOffset(Effect):
    """The speed is logged later than the current, by the same time in every row."""

    slot = Slot.SPEED_DELAY
    cause = "buffering between encoder and log"
    excitation = "steps of voltage, with the current as the time reference"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    delay_s: Delay
    """Delay of the logged speed; the current has none."""

    def apply(self, delay_s: float) -> float:
        return delay_s + self.delay_s

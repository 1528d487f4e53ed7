"""Commands that act late."""

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Delay


class InputDelay(Effect):
    """Each commanded voltage acts later than it is logged, by the same time."""

    slot = Slot.COMMAND_DELAY
    cause = "buffering and a slow bus between controller and driver"
    excitation = "steps of voltage"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    delay_s: Delay
    """Time from a command until its voltage acts."""

    def apply(self, delay_s: float) -> float:
        return delay_s + self.delay_s

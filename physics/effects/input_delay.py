"""Commands that act late."""

from configs.schema.effects.motor import InputDelay
from physics.effects.base import Slot, Term


def later(values: InputDelay, delay_s: float) -> float:
    return delay_s + values.delay_s


TERM = Term(
    InputDelay,
    Slot.COMMAND_DELAY,
    cause="buffering and a slow bus between controller and driver",
    excitation="steps of voltage",
    apply=later,
)

"""Commands that act late."""

from configs.schema.terms.motor import InputDelay
from physics.terms.base import Slot, Term


def later(values: InputDelay, delay_s: float) -> float:
    return delay_s + values.delay_s


TERM = Term(
    InputDelay,
    Slot.COMMAND_DELAY,
    cause="buffering and a slow bus between controller and driver",
    excitation="steps of voltage",
    apply=later,
)

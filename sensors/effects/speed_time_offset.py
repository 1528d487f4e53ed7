"""A speed that is logged late."""

from configs.schema.effects.motor import SpeedTimeOffset
from physics.effects.base import Slot, Term


def later(values: SpeedTimeOffset, delay_s: float) -> float:
    return delay_s + values.delay_s


TERM = Term(
    SpeedTimeOffset,
    Slot.SPEED_DELAY,
    cause="buffering between encoder and log",
    excitation="steps of voltage, with the current as clock",
    apply=later,
)

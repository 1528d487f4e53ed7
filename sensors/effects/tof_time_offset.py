"""Ranges that are logged late."""

from configs.schema.effects.drive import TofTimeOffset
from physics.effects.base import Slot, Term


def later(values: TofTimeOffset, delay_s: float) -> float:
    return delay_s + values.delay_s


TERM = Term(
    TofTimeOffset,
    Slot.RANGE_DELAY,
    cause="timing budget and buffering of the sensor",
    excitation="fast motion towards and past walls",
    apply=later,
)

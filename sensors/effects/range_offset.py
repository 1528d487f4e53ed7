"""Ranges that are too long or too short by the same amount."""

from configs.schema.effects.range_bench import RangeOffset
from physics.effects.base import Slot, Term
from sensors.range_view import RangeView
from symolo.core.arrays import Array


def shifted(values: RangeOffset, reading_m: Array, _view: RangeView) -> Array:
    return reading_m + values.offset_m


TERM = Term(
    RangeOffset,
    Slot.RANGE,
    cause="mounting depth, missing calibration",
    excitation="known distances",
    apply=shifted,
)

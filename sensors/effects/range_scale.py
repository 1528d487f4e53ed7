"""Ranges that grow too fast or too slowly with the distance."""

from configs.schema.effects.range_bench import RangeScale
from physics.effects.base import Slot, Term
from sensors.range_view import RangeView
from symolo.core.arrays import Array


def scaled(values: RangeScale, reading_m: Array, _view: RangeView) -> Array:
    return values.scale * reading_m


TERM = Term(
    RangeScale,
    Slot.RANGE,
    cause="clock of the timing circuit, missing calibration",
    excitation="distances over the whole range",
    apply=scaled,
)

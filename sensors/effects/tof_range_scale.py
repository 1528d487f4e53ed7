"""Ranges of all sensors too long or too short."""

from configs.schema.effects.drive import TofRangeScale
from physics.effects.base import Slot, Term
from sensors.range_view import RangeView
from symolo.core.arrays import Array


def scaled(values: TofRangeScale, reading_m: Array, _view: RangeView) -> Array:
    return values.scale * reading_m


TERM = Term(
    TofRangeScale,
    Slot.RANGE,
    cause="clock of the timing circuits, missing calibration",
    excitation="walls near and far",
    apply=scaled,
)

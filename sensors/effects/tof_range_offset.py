"""Ranges of one sensor that are too long or too short by the same amount."""

import numpy as np

from configs.schema.effects.drive import TofRangeOffset
from physics.effects.base import Slot, Term
from sensors.range_view import RANGE_SENSORS, RangeView
from symolo.core.arrays import Array


def shifted(values: TofRangeOffset, reading_m: Array, _view: RangeView) -> Array:
    return reading_m + np.where(values.sensor == RANGE_SENSORS, values.offset_m, 0.0)


TERM = Term(
    TofRangeOffset,
    Slot.RANGE,
    cause="mounting depth, missing calibration",
    excitation="walls seen by each sensor from known poses",
    apply=shifted,
)

"""Ranges of one sensor that are too long or too short by the same amount, in a drive; on a bench: `range_offset`."""

from typing import Literal

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import RangeShift
from sensors.ranging.range_view import RANGE_SENSORS, RangeView
from symolo.core.arrays import Array


class TofRangeOffset(Effect):
    """All readings of one range sensor are too long or too short by the same distance."""

    slot = Slot.RANGE
    cause = "mounting depth, missing calibration"
    excitation = "walls seen by each sensor from known poses"
    setups = (Setup.DRIVE,)

    sensor: Literal["front", "left", "right"]
    """Sensor with this offset."""
    offset_m: RangeShift
    """Range of that sensor + offset."""

    def apply(self, reading_m: Array, _view: RangeView) -> Array:
        return reading_m + np.where(self.sensor == RANGE_SENSORS, self.offset_m, 0.0)

"""Ranges that are too long or too short by the same amount, on a range bench; in a drive it is `tof_range_offset`."""

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import RangeShift
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array


class RangeOffset(Effect):
    """All readings are too long or too short by the same distance."""

    slot = Slot.RANGE
    cause = "mounting depth, missing calibration"
    excitation = "known distances"
    setups = (Setup.RANGE_BENCH,)

    offset_m: RangeShift
    """reading + offset."""

    def apply(self, reading_m: Array, _view: RangeView) -> Array:
        return reading_m + self.offset_m

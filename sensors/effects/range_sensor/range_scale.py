"""Ranges that are too long or too short by the same factor, on a range bench; in a drive it is `tof_range_scale`."""

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import GeometryScale
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array


class RangeScale(Effect):
    """All readings are a multiple of the distance."""

    slot = Slot.RANGE
    cause = "clock of the timing circuit, missing calibration"
    excitation = "distances over the whole range"
    setups = (Setup.RANGE_BENCH,)

    scale: GeometryScale
    """reading = scale * distance."""

    def apply(self, reading_m: Array, _view: RangeView) -> Array:
        return self.scale * reading_m

"""Ranges of all sensors that are too long or too short by the same factor, in a drive; on a bench: `range_scale`."""

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import GeometryScale
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array


class TofRangeScale(Effect):
    """The readings of all three range sensors are the same multiple of the distance."""

    slot = Slot.RANGE
    cause = "clock of the timing circuits, missing calibration"
    excitation = "near and far walls"
    setups = (Setup.DRIVE,)

    scale: GeometryScale
    """All ranges * scale."""

    def apply(self, reading_m: Array, _view: RangeView) -> Array:
        return self.scale * reading_m

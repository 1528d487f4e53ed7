"""Ranges of one material that are too long or too short."""

from configs.effects.parameter import RangeShift
from sensors.ranging.of_material import OfMaterial
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array


class MaterialBias(OfMaterial):
    """All readings of one material are too long or too short by the same distance."""

    cause = "light that enters a surface before it returns, the shape of the pulse"
    excitation = "several materials at the same distance"

    offset_m: RangeShift
    """reading + offset on that one material."""

    def apply(self, reading_m: Array, view: RangeView) -> Array:
        return reading_m + self.offset_m * self.share(view)

"""Ranges of one material whose error grows with the distance."""

from typing import Annotated

from configs.effects.parameter import Parameter
from sensors.ranging.of_material import OfMaterial
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array

REFERENCE_M = 0.1
"""Distance at which the offsets of materials are measured (paper Tables 3 and 4)."""


class MaterialSlope(OfMaterial):
    """The error of the readings of one material grows linearly with the distance; at 0.1 m it is zero."""

    cause = "low reflection and high refraction, as of glass"
    excitation = "several materials at near and far distances"

    coefficient: Annotated[float, Parameter("1", null=0.0, start=0.04, low=-0.5, high=0.5)]
    """reading + coefficient * (distance - 0.1 m) on that one material."""

    def apply(self, reading_m: Array, view: RangeView) -> Array:
        return reading_m + self.coefficient * (view.distance_m - REFERENCE_M) * self.share(view)

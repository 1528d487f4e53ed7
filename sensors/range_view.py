"""What a range reading may depend on beside the distance."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array

RANGE_SENSORS = np.array(["front", "left", "right"])
"""In the order of every array of ranges."""


@dataclass(frozen=True)
class RangeView:
    """One value per reading; in an array of sensors they are along the last axis."""

    distance_m: Array
    incidence_rad: Array
    """Between the sensor's axis and the normal of what it sees."""
    reflectance: Array
    material_share: Mapping[str, Array]
    """By name of the material, the share of the returned light that comes from it."""
    temperature_C: float | Array
    reference_temperature_C: float
    ambient_lux: float | Array
    time_s: float | Array
    """Since power-on."""

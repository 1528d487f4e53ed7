"""The quantities that a range reading may depend on."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array

RANGE_SENSORS = np.array(["front", "left", "right"])
"""Names of the sensors in the order of every array of ranges."""


@dataclass(frozen=True)
class RangeView:
    """One value per reading; in an array of sensors they are along the last axis."""

    distance_m: Array
    incidence_rad: Array
    """Angle between the sensor's axis and the normal of the surface."""
    reflectance: Array
    material_share: Mapping[str, Array]
    """Share of the returned light that comes from each material, by its name."""
    temperature_C: float | Array
    reference_temperature_C: float
    ambient_lux: float | Array
    time_s: float | Array
    """Time since power-on."""

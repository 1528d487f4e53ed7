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
    previous_distance_m: Array
    """Distance at the sensor's reading before, on a bench that of the row before; the present one at the first reading,
    and in the diagnosis of a drive or a scan, where it is not known."""
    incidence_rad: Array
    """Angle between the sensor's axis and the normal of the surface."""
    tilt_forward_rad: Array
    """Part of this angle by which the axis points above the normal of the surface, positive upwards."""
    tilt_sideways_rad: Array
    """Part of this angle by which the axis points beside the normal of the surface, positive to the left."""
    reflectance: Array
    material_share: Mapping[str, Array]
    """Share of the returned light that comes from each material, by its name."""
    temperature_C: float | Array
    reference_temperature_C: float
    ambient_lux: float | Array
    time_s: float | Array
    """Time since power-on."""

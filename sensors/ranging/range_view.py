"""The quantities that a range reading may depend on."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array

RANGE_SENSORS = np.array(["front", "left", "right"])
"""Names of the sensors in the order of every array of ranges."""
OTHER_SENSOR = -1
"""Index of a sensor that is none of the three on the robot, such as one on a bench."""
FACING = 0.7
"""Cosine of the largest angle, about 45 degrees, up to which a surface faces in a direction."""


@dataclass(frozen=True)
class RangeView:
    """One value per reading; in an array of sensors they are along the last axis."""

    distance_m: Array
    """True distance to the surface, as the mean over the rays of the beam, weighted with the light that returns."""
    previous_distance_m: Array
    """Distance at the sensor's reading before, on a bench and in a log of the case format that of the row before; the
    present one at the first reading, and in the diagnosis of a scan or of a log whose rows repeat readings."""
    incidence_rad: Array
    """Angle between the sensor's axis and the normal of the surface."""
    tilt_forward_rad: Array
    """Part of this angle by which the axis points above the normal of the surface, positive upwards."""
    tilt_sideways_rad: Array
    """Part of this angle by which the axis points beside the normal of the surface, positive to the left."""
    reflectance: Array
    """Share of the sensor's infrared light that the surface returns, 0 to 1."""
    material_share: Mapping[str, Array]
    """Share of the returned light that comes from each material, by its name."""
    temperature_C: float | Array
    """Temperature of the sensor."""
    reference_temperature_C: float
    """Temperature at which the sensor was calibrated."""
    ambient_lux: float | Array
    """Light of the surroundings on the target."""
    time_s: float | Array
    """Time since power-on."""
    sensor: int | NDArray[np.int64] = OTHER_SENSOR
    """Index among `RANGE_SENSORS`, or `OTHER_SENSOR`."""
    normal_rad: float | Array = 0.0
    """Direction of the normal of the surface in W, counter-clockwise from +x; 0 on a bench."""

    def of_sensor(self, name: str) -> Array:
        """Return 1 for the readings of one sensor of the robot, and 0 for others."""
        return np.where(np.equal(self.sensor, RANGE_SENSORS.tolist().index(name)), 1.0, 0.0)

    def facing(self, direction_rad: float) -> Array:
        """Return 1 for surfaces that face in a direction in W, to 45 degrees, and 0 for others."""
        return np.where(np.cos(self.normal_rad - direction_rad) > FACING, 1.0, 0.0)

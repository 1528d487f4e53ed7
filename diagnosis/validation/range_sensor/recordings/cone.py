"""The sensor's cone with light that falls off with a power of the distance: the same rays and weights otherwise.

At power 0 it is the sensor's own mean, to which a test holds it. At 2 it is what a receiver gets back from a matt
surface that a beam lights, which the sensor leaves out.
"""

from dataclasses import dataclass

import numpy as np

from configs.schema.robot import TofMount, TofSensor
from diagnosis.validation.still_world import RayCaster
from sensors.tof import ray_directions, ray_pattern
from symolo.core.arrays import Array


@dataclass(frozen=True)
class Cone:
    """The rays of a range sensor that looks along the x axis, with their weights."""

    directions: Array
    """(rays, 3), unit vectors about the x axis."""
    profile: Array
    """(rays,), intensity of the beam along each ray."""
    head_on: float
    """Mean cosine of the rays, by which the device is calibrated on a plane board."""
    reach_m: float

    @classmethod
    def of_sensor(cls, tof: TofSensor) -> "Cone":
        angle, roll = ray_pattern(tof.rays, np.radians(tof.field_of_view_deg))
        profile = np.exp(-0.5 * (angle / np.radians(tof.beam_sigma_deg)) ** 2)
        ahead = TofMount(x_m=0.0, y_m=0.0, z_m=1.0, yaw_deg=0.0)
        head_on = float(np.sum(profile * np.cos(angle)) / np.sum(profile))
        return cls(ray_directions(ahead, angle, roll), profile, head_on, 1.25 * tof.max_range_m)

    def ranges_m(self, caster: RayCaster, places: Array, power: float) -> Array:
        """Return the range at each place (P, 3) of the sensor in W, looking along x, (P,)."""
        rays = len(self.directions)
        origins = np.repeat(places, rays, axis=0)
        steps = np.tile(self.reach_m * self.directions, (len(places), 1))
        hits = caster.cast(origins, origins + steps)
        cosine = np.abs(np.einsum("ij,ij->i", steps, hits.normal)) / self.reach_m
        distance = (hits.fraction * self.reach_m).reshape(-1, rays)
        light = self.profile * (cosine * (hits.surface >= 0)).reshape(-1, rays) * distance**-power
        return self.head_on * (light * distance).sum(axis=1) / light.sum(axis=1)

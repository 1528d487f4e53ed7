"""Closed forms of the real scan: a ball in front of a plane board, and the range that a cone of rays reads.

The light of a ray falls off with a power of the distance; otherwise rays and weights are those of the sensor. At power
0 the range is that of the sensor, which a test checks. At power 2 it is what a receiver gets back from a matt surface
that a beam lights, which the sensor leaves out.
"""

from dataclasses import dataclass

import numpy as np

from configs.schema.robot import TofMount, TofSensor
from diagnosis.validation.range_sensor.stand import HEIGHT_M
from diagnosis.validation.still_world import RayCaster
from physics.arena.rays import RayHits
from sensors.tof import ray_directions, ray_pattern
from symolo.core.arrays import Array

BALL, BOARD = 1, 2


@dataclass(frozen=True)
class BallScene:
    """A ball and a board behind it, for rays that start in front of both and point towards +x."""

    nearest_m: float
    """Distance from the plane x = 0 to the ball."""
    radius_m: float
    board_m: float
    """Distance from the plane x = 0 to the board."""
    y_m: float = 0.0
    """Lateral coordinate of the centre of the ball."""
    z_m: float = HEIGHT_M
    """Height of the centre of the ball."""

    def cast(self, origins: Array, ends: Array) -> RayHits:
        """Return hits with surface 1 for the ball and 2 for the board; no ray meets the floor."""
        step = ends - origins
        from_centre = origins - (self.nearest_m + self.radius_m, self.y_m, self.z_m)
        # |from_centre + f step| = radius, a quadratic in the fraction f.
        a = np.einsum("ij,ij->i", step, step)
        half_b = np.einsum("ij,ij->i", from_centre, step)
        c = np.einsum("ij,ij->i", from_centre, from_centre) - self.radius_m**2
        under_root = half_b**2 - a * c
        first = (-half_b - np.sqrt(np.maximum(under_root, 0.0))) / a
        on_ball = (under_root > 0.0) & (first > 0.0) & (first <= 1.0)
        at_board = (self.board_m - origins[:, 0]) / step[:, 0]
        on_board = ~on_ball & (at_board > 0.0) & (at_board <= 1.0)
        fraction = np.where(on_ball, first, np.where(on_board, at_board, 1.0))
        outward = (from_centre + fraction[:, None] * step) / self.radius_m
        towards = np.where(on_board[:, None], (-1.0, 0.0, 0.0), 0.0)
        surface = np.where(on_ball, BALL, np.where(on_board, BOARD, -1))
        return RayHits(fraction, surface, np.where(on_ball[:, None], outward, towards))


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

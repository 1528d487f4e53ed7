"""A 2D lidar: rays in one plane, one after the other while the head turns and the robot drives."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import ceil
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from configs.robot_sensors import MountedSettings, SensorSettings
from configs.schema.base import Fixed
from configs.validation.faults import ConfigFault
from physics.arena.surfaces import SURFACES
from sensors.base import Reading, Sensor, World, quantise
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.dataset.tables.column import Column
from symolo.dataset.tables.sensor_tables import MAX_COLUMNS

SUBSAMPLE_S = 0.01
"""Longest time between two poses within a sweep; between them the robot is taken to move at constant speed."""
COLUMNS = Fixed("it decides the columns of the table")


def _around(settings: Mapping[str, Any]) -> float:
    """Return the step between rays that look all around."""
    rays = settings.get("rays", 1)
    return 360.0 / rays if rays > 1 else 1.0


class LidarSettings(MountedSettings):
    """Place, rays and errors of a 2D lidar; the defaults are those of a cheap one with a range of 8 m."""

    z_m: float = Field(default=0.1, ge=0, le=2)
    """Height of the plane of the rays above the floor [m]."""
    period_s: float = Field(default=0.1, gt=0, le=1)
    """Time between two scans."""
    sweep_s: float = Field(default=0.1, ge=0, le=1)
    """Time from the first ray of a scan to the first ray of the next turn; 0 if all rays are measured at once."""
    rays: Annotated[int, COLUMNS] = Field(default=360, ge=1, le=MAX_COLUMNS)
    """Number of rays of a scan."""
    first_ray_deg: float = Field(default=-180.0, ge=-360, le=360)
    """Direction of the first ray to the left of the x axis of the sensor."""
    ray_step_deg: float = Field(default_factory=_around, ge=-180, le=180)
    """Angle from a ray to the next one, counter-clockwise; below 0 for a head that turns clockwise. By default 360 over
    the number of rays, so that they look all around."""
    min_range_m: float = Field(default=0.05, ge=0, le=10)
    """Smallest range that is measured [m]."""
    max_range_m: float = Field(default=8.0, gt=0, le=100)
    """Largest range that is measured [m]."""
    detection_reflectance: float = Field(default=0.1, ge=0, le=1)
    """Reflectance of the darkest surface that still returns enough light head-on at `max_range_m`. The light falls with
    the square of the distance and the cosine of the incidence."""
    noise_m: float = Field(default=0.004, ge=0, le=1)
    """Standard deviation of a range at close distance [m]."""
    noise_share: float = Field(default=0.004, ge=0, le=0.5)
    """Growth of this standard deviation per metre of range; both are added as variances."""
    offset_sd_m: float = Field(default=0.003, ge=0, le=1)
    """Standard deviation of the offset of all ranges, drawn once per run [m]."""
    intensity_noise: float = Field(default=0.02, ge=0, le=1)
    """Standard deviation of the intensity."""
    quantisation_m: float = Field(default=0.001, ge=0, le=0.1)
    """Step of the ranges [m]; 0 for none."""
    dropout_probability: float = Field(default=0.002, ge=0, le=1)
    """Probability that a ray gives no range."""

    def faults(self) -> Iterator[ConfigFault]:
        if self.min_range_m >= self.max_range_m:
            allowed = f"less than max_range_m, which is {self.max_range_m}"
            yield ConfigFault(("min_range_m",), got=self.min_range_m, allowed=allowed, against=("max_range_m",))
        if self.sweep_s > self.period_s:
            allowed = f"at most period_s, which is {self.period_s}"
            yield ConfigFault(("sweep_s",), got=self.sweep_s, allowed=allowed, against=("period_s",))
        if self.rays > 1 and not 0 < abs(self.ray_step_deg) <= 360 / self.rays + 1e-9:
            allowed = f"an angle other than 0 of at most {360 / self.rays:.9g}, 360 over the number of rays, in size"
            yield ConfigFault(("ray_step_deg",), got=self.ray_step_deg, allowed=allowed, against=("rays",))


class Lidar(Sensor):
    """Ranges and intensities of the rays of a scan, the first ray first; t is the time of the last ray.

    The intensity is corrected for the distance: 1 is a white surface head-on. A ray without a return has the range 0
    and the intensity 0.
    """

    Settings = LidarSettings
    settings: LidarSettings

    def __init__(self, settings: SensorSettings, arena: Arena, physics_hz: int, rng: np.random.Generator) -> None:
        super().__init__(settings, arena, physics_hz, rng)
        config, count = self.settings, self.settings.rays
        X_RS = config.X_RS()
        angles = np.radians(config.first_ray_deg + config.ray_step_deg * np.arange(count))
        rays_S = np.stack([np.cos(angles), np.sin(angles), np.zeros(count)], axis=1)
        self._origin_R, self._rays_R = X_RS[:3, 3], rays_S @ X_RS[:3, :3].T
        self._late_s = config.sweep_s * (np.arange(count) - count + 1) / count
        """(rays,), time of each ray after the last one, so that it is never above 0."""
        subsamples = ceil(config.sweep_s / SUBSAMPLE_S)
        before = {round(config.sweep_s * physics_hz * k / subsamples) for k in range(1, subsamples + 1)}
        self.sampling = replace(self.sampling, subsamples_before=tuple(sorted(before - {0}, reverse=True)))
        self._poses: list[tuple[float, float, float, float]] = []
        """Time, x, y and yaw at the subsamples since the last scan."""
        surfaces = [SURFACES[box.surface].reflectance for box in arena.boxes]
        self._reflectance = np.array([arena.floor_reflectance, *surfaces])
        self._offset_m = config.offset_sd_m * float(rng.standard_normal())
        self._moves = bool(arena.moving)

    @classmethod
    def columns_of(cls, settings: SensorSettings) -> tuple[Column, ...]:
        count = settings.rays if isinstance(settings, LidarSettings) else 1
        return (
            Column("range", "m", 4, "distance along the ray, 0 for no return", count),
            Column("intensity", "-", 3, "returned light, 1 for a white surface head-on, 0 for no return", count),
        )

    def subsample(self, world: World) -> None:
        self._poses.append((world.time_s, *world.pose()))

    def sample(self, world: World) -> Reading:
        """Return the ranges [m] and then the intensities of the rays, (2 rays,)."""
        config = self.settings
        self.subsample(world)
        range_m, returned = self._true(world)
        normal = self.rng.standard_normal((2, config.rays))
        sd_m = np.hypot(config.noise_m, config.noise_share * range_m)
        reading_m = quantise(range_m + self._offset_m + sd_m * normal[0], config.quantisation_m)
        valid = (returned > 0.0) & (returned * config.max_range_m**2 >= config.detection_reflectance * range_m**2)
        valid &= (reading_m >= config.min_range_m) & (reading_m <= config.max_range_m)
        valid &= self.rng.random(config.rays) >= config.dropout_probability
        intensity = np.clip(returned + config.intensity_noise * normal[1], 0.0, 1.0)
        return np.concatenate([np.where(valid, reading_m, 0.0), np.where(valid, intensity, 0.0)])

    def _true(self, world: World) -> tuple[Array, Array]:
        """Return true range [m] and returned share of light of each ray, (rays,) each; both are 0 without a surface."""
        at_s = world.time_s + self._late_s
        known = np.array(self._poses)
        self._poses = self._poses[-1:]
        x, y, yaw = (np.interp(at_s, known[:, 0], column) for column in known.T[1:])
        c, s = np.cos(yaw), np.sin(yaw)
        reach_m = 1.25 * self.settings.max_range_m
        origins = self._turned(np.broadcast_to(self._origin_R, self._rays_R.shape), c, s)
        origins[:, 0] += x
        origins[:, 1] += y
        directions = self._turned(self._rays_R, c, s)
        fraction, surface, cosine = self._cast(world, origins, directions, reach_m, at_s, known[:, 0])
        met = surface >= 0
        return np.where(met, fraction * reach_m, 0.0), np.where(met, self._reflectance[surface] * cosine, 0.0)

    def _cast(  # noqa: PLR0917 - all of them describe the rays
        self, world: World, origins: Array, directions: Array, reach_m: float, at_s: Array, subsamples_s: Array
    ) -> tuple[Array, NDArray[np.int64], Array]:
        """Return fraction of the reach, surface and cosine of the incidence of each ray, (rays,) each."""
        # Moving obstacles have one place between two subsamples, in which they move a few millimetres at most.
        groups = np.searchsorted(subsamples_s, at_s) if self._moves else np.zeros(len(at_s), np.int64)
        fraction, cosine = np.empty(len(at_s)), np.empty(len(at_s))
        surface = np.empty(len(at_s), np.int64)
        for group in np.unique(groups):
            rays = groups == group
            time_s = float(at_s[rays].mean()) if self._moves else None
            hits = world.cast(origins[rays], origins[rays] + reach_m * directions[rays], time_s)
            fraction[rays], surface[rays] = hits.fraction, hits.surface
            cosine[rays] = np.abs(np.einsum("ij,ij->i", directions[rays], hits.normal))
        return fraction, surface, cosine

    @staticmethod
    def _turned(vectors: Array, c: Array, s: Array) -> Array:
        """Return vectors (rays, 3) turned about the vertical, each by its own angle."""
        x, y, z = vectors.T
        return np.stack([c * x - s * y, s * x + c * y, z], axis=1)

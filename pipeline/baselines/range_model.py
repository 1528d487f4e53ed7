"""The readings of the ToF sensors that the map predicts for many poses at once, and their uncertainty.

A sensor is a cone of few rays whose ranges are averaged by beam profile and incidence, as the paper's section 6 has it.
"""

from dataclasses import dataclass
from math import radians

import numpy as np
from numpy.typing import NDArray

from physics.arena.rays import RayScene
from pipeline.baselines.robot_knowledge import MAP_SD_M, RobotKnowledge
from sensors.ranging.tof import NOISE_AT_NEAR_MM, log_error_m, noise_sd_m, ray_directions, ray_pattern
from symolo.core.arrays import Array

BEAM_SD_SHARE = 0.28
"""Standard deviation of the beam as a share of the field of view: at its edge the beam falls to about a fifth."""
MIN_SIGNAL = 0.15
"""Share of the light that a wall head-on returns; with less the device reports no target."""
REACH = 1.25
"""Length of a ray as a share of the longest range."""

SURFACE_SD_M = 0.0041
"""Root mean square [m] of the offsets of the nine materials at 100 mm (Tables 3 and 4 of the paper)."""
LASTING_SD_M = float(np.hypot(SURFACE_SD_M, MAP_SD_M))
"""Standard deviation [m] of an offset that stays while the robot looks at one wall."""
GAIN_SD = 0.03 / float(log_error_m(np.array(1.0)))
"""Scale of the error in the form of Eq. 24: at 1 m it gives the 3 % of the data sheet of the VL53L0X."""
OFFSET_SD_M = 0.003
"""Standard deviation of the offset of a sensor with its place on the robot, if both are measured by hand (assumed)."""
MOUNT_SD_RAD = radians(1.0)
"""Standard deviation of the angle by which a sensor is turned in its mount (assumed)."""


@dataclass(frozen=True)
class BeamView:
    """What the beams of the three sensors meet on the map from one pose."""

    share: Array
    """(3, 1 + B), share of the floor and of each of the B walls and obstacles in the mean range of a sensor."""
    spread_m: Array
    """(3,), standard deviation of the ranges over the rays of a sensor, with their weights; 0 without a target."""


@dataclass(frozen=True)
class _Rays:
    """Rays of the three sensors from P poses."""

    range_m: Array
    """(P, 3, rays), distance to the map; that of the end of the ray if it meets nothing."""
    weight: Array
    """(P, 3, rays), by beam profile and incidence; 0 for a ray that meets nothing."""
    surface: NDArray[np.int64]
    """(P, 3, rays), number of the surface that a ray meets, 0 for the floor, -1 for none."""


class RangeModel:
    """Expected readings of the three ToF sensors at any pose, and their standard deviations, by walls and obstacles of
    the map.
    """

    def __init__(self, knowledge: RobotKnowledge, rays: int) -> None:
        """Return the model with that number of rays for each sensor."""
        drawing = knowledge.drawing
        self._scene = RayScene(knowledge.map)
        self._surfaces = 1 + len(knowledge.map.boxes)
        self._longest_m = drawing.longest_range_m
        angle, roll = ray_pattern(rays, drawing.field_of_view_rad)
        self._profile = np.exp(-0.5 * (angle / (BEAM_SD_SHARE * drawing.field_of_view_rad)) ** 2)
        self._profile /= self._profile.sum()
        self._head_on = float(self._profile @ np.cos(angle))
        self._directions_R = np.concatenate([ray_directions(mount, angle, roll) for mount in drawing.mounts])
        self._mounts_R = np.array([[mount.x_m, mount.y_m] for mount in drawing.mounts])
        origins = [[mount.x_m, mount.y_m, mount.z_m] for mount in drawing.mounts]
        self._origins_R = np.repeat(np.array(origins), rays, axis=0)
        self.age_s = 0.5 * drawing.range_period_s
        """Mean age [s] of a reading: it is taken at some time in the device's period before the row."""
        self.age_sd_s = drawing.range_period_s / np.sqrt(12.0)

    def expected(self, poses: Array) -> Array:
        """Return the readings (P, 3) [m] that the map predicts at the poses (P, 3); nan where it predicts no target."""
        rays = self._rays(poses)
        returned = rays.weight.sum(axis=2)
        range_m = self._head_on * (rays.weight * rays.range_m).sum(axis=2) / np.maximum(returned, 1e-12)
        seen = (returned >= MIN_SIGNAL * self._head_on) & (range_m <= self._longest_m)
        return np.where(seen, range_m, np.nan)

    def expected_and_turn_error(self, poses: Array, mean: Array) -> tuple[Array, Array]:
        """Return `expected` at the poses (P, 3), and the error (3,) [m] that a turn of each sensor in its mount by one
        standard deviation causes at the mean pose (3,); 0 where the turned sensor may see no target.
        """
        all_expected_m = self.expected(np.concatenate([poses, self._turned_in_mounts(mean)]))
        each = np.arange(3)
        left_m, right_m = all_expected_m[len(poses) :].reshape(2, 3, 3)[:, each, each]
        return all_expected_m[: len(poses)], np.nan_to_num(0.5 * np.abs(left_m - right_m))

    def view(self, pose: Array) -> BeamView:
        """Return what the beams meet from a pose (3,)."""
        rays = self._rays(pose[None])
        weight = rays.weight[0] / np.maximum(rays.weight[0].sum(axis=1, keepdims=True), 1e-12)
        met = rays.surface[0][..., None] == np.arange(self._surfaces)
        from_mean_m = rays.range_m[0] - (weight * rays.range_m[0]).sum(axis=1, keepdims=True)
        return BeamView(np.einsum("ij,ijk->ik", weight, met), np.sqrt((weight * from_mean_m**2).sum(axis=1)))

    def _turned_in_mounts(self, pose: Array) -> Array:
        """Return poses (6, 3) in which a sensor is where the pose (3,) has it, but turned: each of three left, then
        each right.
        """
        yaw = pose[2] + MOUNT_SD_RAD * np.array([0.0, 1.0, -1.0])[:, None]
        c, s = np.cos(yaw), np.sin(yaw)
        x, y = self._mounts_R.T
        place = np.stack([c * x - s * y, s * x + c * y], axis=2)
        turned = np.empty((2, 3, 3))
        turned[..., :2] = pose[:2] + place[0] - place[1:]
        turned[..., 2] = yaw[1:]
        return turned.reshape(6, 3)

    def _rays(self, poses: Array) -> _Rays:
        reach_m = REACH * self._longest_m
        turned = _turned(self._directions_R, poses)
        origins = _turned(self._origins_R, poses)
        origins[..., :2] += poses[:, None, :2]
        flat, along = origins.reshape(-1, 3), turned.reshape(-1, 3)
        hits = self._scene.cast(flat, flat + reach_m * along)
        shape = (len(poses), 3, len(self._profile))
        cosine = np.abs(np.einsum("ij,ij->i", along, hits.normal)).reshape(shape)
        return _Rays(reach_m * hits.fraction.reshape(shape), self._profile * cosine, hits.surface.reshape(shape))


def white_sd_m(range_m: Array | float) -> Array:
    """Return the standard deviation of the noise that is new in every reading: Eq. 23."""
    return noise_sd_m(np.array(1e-3 * NOISE_AT_NEAR_MM), np.asarray(range_m))


def lasting_sd_m(range_m: Array) -> Array:
    """Return the standard deviation of the error that stays while the robot looks at the same wall: its material, and
    the accuracy of the device.
    """
    return np.hypot(LASTING_SD_M, GAIN_SD * log_error_m(range_m))


def _turned(vectors_R: Array, poses: Array) -> Array:
    """Return vectors of R (K, 3) along the axes of W, (P, K, 3), for poses (P, 3)."""
    c, s = np.cos(poses[:, 2:]), np.sin(poses[:, 2:])
    x, y, z = vectors_R.T
    return np.stack([c * x - s * y, s * x + c * y, np.broadcast_to(z, (len(poses), len(z)))], axis=2)

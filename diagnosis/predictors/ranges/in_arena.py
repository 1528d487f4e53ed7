"""Logged pose -> readings of the three range sensors in a known arena, by rays over the cone of each sensor.

A fit needs thousands of predictions, and rays cost most of their time. They are cast in those rows only whose reading
counts, and on a grid of the parameters that move a sensor; between its points, the results are interpolated. This also
smooths the steps that a ray makes when it crosses an edge.
"""

from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass
from math import floor, sqrt

import numpy as np
from numpy.typing import NDArray

from configs.effects.base import Effect, Slot
from configs.effects.robot_effects import RobotEffects
from configs.schema.arena import ArenaConfig
from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.case_format import RANGE_SIDES
from diagnosis.measured.case_files.nominal import LogNoise
from diagnosis.measured.case_files.symolo_columns import RANGE_READINGS
from diagnosis.measured.channel import Mask
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.ranges.arenas import LogArenas
from diagnosis.predictors.ranges.base import CORNER_M, CORNER_RAD, END_M, Ranges, Sight, Surroundings
from diagnosis.predictors.rows import trial_of_rows
from physics.robot.model import applied
from physics.robot.stack import stacked_effects
from sensors.ranging.tof import beam_profile, head_on_factor, log_error_m, noise_sd_m, ray_directions, ray_pattern
from symolo.core.arrays import Array

MOVING = frozenset(
    {
        Slot.POSE_POINT,
        Slot.POSE_HEADING,
        Slot.POSE_DELAY,
        Slot.RANGE_DELAY,
        Slot.RANGE_GATHERING,
        Slot.RANGE_MOUNT,
    }
)
"""Slots of the effects that move a sensor."""
GRID = 0.1
"""Spacing of the grid of a parameter, as a share of its start value in a fit. It is 10 mrad for an angle, 4 ms for a
delay and 2 mm for a length."""
NEAREST_M = 0.05
"""Smallest distance of an edge, for the angle by which it moves if the robot moves sideways."""
EDGE_M = 0.02
"""Smallest difference between the range and the mean of two neighbouring ranges, times two, at which a sensor sees an
edge. The neighbours are the ranges of the same sensor after a small turn or shift to the left and to the right."""
REACH = 1.25
"""Length of a ray as a share of the longest range (`sensors.ranging.tof`)."""
EXACT = 1e-9
"""Share of a period by which rounding may move the time of a sample."""


@dataclass(frozen=True)
class _Cone:
    """Rays of one sensor about its axis."""

    angle_rad: Array
    roll_rad: Array
    profile: Array
    """(rays,), weight of each ray."""

    weighting: tuple[Callable[..., Array], ...]
    """Effects on the weights of rays."""
    head_on: float
    """Factor from the mean length of the rays to a wall head-on to its distance."""
    full_signal: float
    """Light that returns from a white wall head-on."""

    @classmethod
    def from_robot(cls, robot: RobotConfig) -> "_Cone":
        angle, roll = ray_pattern(robot.tof.rays, np.radians(robot.tof.field_of_view_deg))
        profile, weighting = beam_profile(robot.tof, angle), robot.effects.functions(Slot.RAY_WEIGHT)
        full_signal = head_on_factor(profile, angle) * float(profile.sum())
        return cls(angle, roll, profile, weighting, head_on_factor(profile, angle, weighting), full_signal)


@dataclass(frozen=True)
class _View:
    """What one sensor sees from n poses of a path. All arrays without a shape are (n,)."""

    distance_m: Array
    by_pose: Array
    """(n, 3), derivative of the distance by x, y and yaw of the axle, on the surfaces that are hit."""
    by_edge: Array
    """Change of the distance by a turn [m/rad], without the change on the surfaces that are hit: the part that comes
    from light which moves from one surface to another."""
    normal: Array
    """(n, 3), mean normal of the surfaces, weighted by their light, along axis, left and up of the sensor."""
    shares: Array
    """(n, surfaces), share of the returned light that comes from each surface."""
    has_target: Mask

    def variance(self, noise: LogNoise | None, moved: Array) -> Array:
        """Return the variance of the distance by noise of pose and time (n,) [m2].

        Args:
            noise: Noise of the poses; None if they are exact.
            moved: (n, 3), standard deviation of the motion of the axle by the unknown time of a reading.
        """
        by_x, by_y, by_yaw = self.by_pose.T
        xy_m, theta_rad = (noise.pose_xy_m, noise.pose_theta_rad) if noise else (0.0, 0.0)
        smooth = (by_x**2 + by_y**2) * xy_m**2 + by_yaw**2 * theta_rad**2
        by_time = np.einsum("ij,ij->i", self.by_pose, moved)
        # A shift moves an edge as a turn by the angle under which it is seen does.
        turn = theta_rad**2 + (xy_m / np.maximum(self.distance_m, NEAREST_M)) ** 2
        return smooth + by_time**2 + self.by_edge**2 * (turn + moved[:, 2] ** 2)


class RangesInArena(Ranges):
    """Ranges in the arena of each trial, of a data.csv of the SyMoLo format or of simulated runs."""

    channels = RANGE_READINGS

    def __init__(
        self, measurement: Measurement, arenas: Sequence[ArenaConfig], noise: LogNoise | None, nominal: RobotConfig
    ) -> None:
        """
        Args:
            measurement: The log.
            arenas: Arena of each trial.
            noise: Noise of the log; None for a simulated one. Its poses are exact, its sensors sample from the start of
                each trial on, and the noise of a range is that of the surface.
            nominal: The nominal robot.
        """
        self._noise, self._tof, self._arenas = noise, nominal.tof, LogArenas(arenas)
        surfaces = self._arenas.surfaces
        numbers = [
            (each.offset_m, noise.d_m if noise else self._tof.noise_scale * each.noise_sd_m, each.reflectance)
            for each in surfaces
        ]
        self._properties = np.hstack([np.array(numbers), self._arenas.made_of])
        """(surfaces, 3 + materials), offset [m], noise of a near range [m], reflectance, and 1 for its material."""
        self._cones: dict[Hashable, _Cone] = {}
        self._trial = trial_of_rows(measurement)
        self._known: dict[Hashable, Array] = {}
        self._rows: list[NDArray[np.int64]] = []
        self.resolution_m = nominal.tof.quantisation_m
        super().__init__(measurement, nominal)
        self._rows = [np.flatnonzero(observed.usable) for observed in self.observed]
        self._known.clear()

    def _ages_s(self, delay_s: float | Array) -> float | Array:
        delay_s, period_s = delay_s + self._tof.delay_s, self._tof.period_s
        if self._noise is not None:
            # A row repeats a reading until the next one; when a sensor began to sample is not logged.
            return delay_s + 0.5 * period_s
        samples = np.floor((self._t_s - delay_s) / period_s + EXACT)
        return self._t_s - period_s * np.maximum(samples, 0.0)

    def _around(self, nominal: RobotConfig) -> Surroundings:
        path = self._path(nominal)
        self._rows = [np.arange(len(self._t_s))] * len(RANGE_SIDES)
        cone = self._cone(nominal)
        views = [self._cast(k, path, 0.0, cone) for k in range(len(RANGE_SIDES))]
        clear = [self._is_clear(k, path, view, cone) for k, view in enumerate(views)]
        surface = np.stack([view.shares.argmax(axis=-1).astype(float) for view in views], axis=-1)
        names = tuple(surface.name for surface in self._arenas.surfaces)
        return Surroundings(np.stack(clear, axis=-1), surface, names)

    def _path(self, robot: RobotConfig) -> Array:
        """Return pose of the axle and time since the start of the session, (n, 4), of each row's reading."""
        return np.column_stack([self._axle([robot]), self._since_on_s - self._age_s([robot])])

    def _cone(self, robot: RobotConfig) -> _Cone:
        """Return the rays of a robot, of which only their weights may differ from those of the nominal one."""
        key = _numbers(robot.effects.in_slots({Slot.RAY_WEIGHT}))
        if key not in self._cones:
            self._cones[key] = _Cone.from_robot(robot)
        return self._cones[key]

    def _is_clear(self, k: int, path: Array, view: _View, cone: _Cone) -> Mask:
        """Return the rows in which a sensor has a target, and no edge beside it."""
        mount = getattr(self._tof.mounts, RANGE_SIDES[k])
        across = path[:, 2] + np.radians(mount.yaw_deg) + 0.5 * np.pi
        zero = np.zeros(len(path))
        aside = CORNER_M * np.stack([np.cos(across), np.sin(across), zero, zero], axis=-1)
        both_sides = (
            [self._cast(k, path, turn, cone) for turn in (-CORNER_RAD, CORNER_RAD)],
            [self._cast(k, path + shift, 0.0, cone) for shift in (-aside, aside)],
        )
        clear = view.has_target & (view.distance_m <= self._tof.max_range_m - END_M)
        for before, after in both_sides:
            clear &= np.abs(before.distance_m + after.distance_m - 2.0 * view.distance_m) < EDGE_M
        return clear

    def _sight(self, robots: Sequence[RobotConfig]) -> Sight:
        # Rows whose reading does not count are predicted as if nothing were there.
        seen = np.zeros((5 + self._properties.shape[1], len(robots), len(self._t_s), len(RANGE_SIDES)))
        seen[0], seen[1], seen[7] = self._tof.max_range_m, -1.0, 1.0
        for m, robot in enumerate(robots):
            for k, rows in enumerate(self._rows):
                seen[:, m, rows, k] = self._seen(k, robot)
        distance, axial, left, up, variance, offset, near_sd, reflectance, *materials = seen
        length = np.maximum(np.sqrt(axial**2 + left**2 + up**2), 1e-12)
        # The growth of the noise with the distance (Eq. 23).
        growth = noise_sd_m(np.zeros(()), distance) * self._tof.noise_scale
        return Sight(
            distance_m=distance,
            reading_m=distance + offset + self._tof.error_scale * log_error_m(distance),
            sd_m=np.hypot(near_sd, growth),
            incidence_rad=np.arccos(np.clip(-axial / length, -1.0, 1.0)),
            tilt_forward_rad=np.arctan2(up, -axial),
            tilt_sideways_rad=np.arctan2(left, -axial),
            reflectance=reflectance,
            material_share=dict(zip(self._arenas.materials, materials, strict=True)),
            pose_variance=variance,
            normal_rad=self._axis_rad(robots) + np.arctan2(left, axial),
        )

    def _axis_rad(self, robots: Sequence[RobotConfig]) -> Array:
        """Return the directions of the axes of the sensors in W, (n, 3) or (M, n, 3)."""
        functions = stacked_effects(robots, axes=2).functions(Slot.RANGE_MOUNT)
        yaw_rad = np.radians([getattr(self._tof.mounts, side).yaw_deg for side in RANGE_SIDES])
        return self._axle(robots)[..., 2:] + applied(functions, yaw_rad)

    def _seen(self, k: int, robot: RobotConfig) -> Array:
        """Return distance, normal, variance and properties of the surfaces in the rows that count, (F, n)."""
        corners: list[tuple[float, tuple[Effect, ...]]] = [(1.0, ())]
        for effect in robot.effects.in_slots(MOVING):
            if effect.slot is Slot.RANGE_MOUNT and not effect.apply(np.zeros(len(RANGE_SIDES)))[k]:
                continue
            corners = [
                (weight * share, (*effects, near)) for weight, effects in corners for share, near in _neighbours(effect)
            ]
        return sum((weight * self._at(k, robot, effects) for weight, effects in corners), np.zeros(()))

    def _at(self, k: int, robot: RobotConfig, effects: tuple[Effect, ...]) -> Array:
        """Return the same for a robot whose effects that move a sensor are these."""
        key = (k, _numbers(effects), _numbers(robot.effects.in_slots({Slot.RAY_WEIGHT})))
        if key not in self._known:
            there = robot.model_copy(update={"effects": RobotEffects(effects)})
            path = self._path(there)
            askew = float(applied(there.effects.functions(Slot.RANGE_MOUNT), np.zeros(len(RANGE_SIDES)))[k])
            view = self._cast(k, path[self._rows[k]], askew, self._cone(robot))
            variance = view.variance(self._noise, self._moved(path[:, :3])[self._rows[k]])
            self._known[key] = np.stack(
                [view.distance_m, *view.normal.T, variance, *(view.shares @ self._properties).T]
            )
        return self._known[key]

    def _moved(self, path: Array) -> Array:
        """Return the standard deviation of the motion of the axle (n, 3) by what is not known of the times of readings.

        Args:
            path: (n, 3), poses at the times of the readings.
        """
        moved = np.zeros_like(path)
        for trial in np.unique(self._trial).tolist():
            rows = np.flatnonzero(self._trial == trial)
            if self._noise is not None and len(rows) > 1:
                speed = np.gradient(path[rows], self._t_s[rows], axis=0)
                moved[rows] = speed * self._tof.period_s / sqrt(12.0)
            elif self._noise is None and len(rows) > 2:
                # A wheel that changes its speed at once, between two rows, is off the straight line between them by
                # a quarter of the change per row.
                bend = np.pad(np.diff(self._tracked.pose[rows], 2, axis=0), ((1, 1), (0, 0)), mode="edge")
                moved[rows] = 0.25 * (np.abs(bend) + np.abs(np.vstack([bend[:1], bend[:-1]])))
        return moved

    def _cast(self, k: int, path: Array, askew_rad: float, cone: _Cone) -> _View:
        """Return what a sensor sees along a path (n, 4) of poses and times."""
        mount = getattr(self._tof.mounts, RANGE_SIDES[k])
        c, s = np.cos(path[:, 2]), np.sin(path[:, 2])
        ahead = np.stack([c * mount.x_m - s * mount.y_m, s * mount.x_m + c * mount.y_m], axis=-1)
        x, y, z = ray_directions(mount, cone.angle_rad, cone.roll_rad, askew_rad).T
        along = np.empty((len(path), len(x), 3))
        along[..., 0], along[..., 1] = np.outer(c, x) - np.outer(s, y), np.outer(s, x) + np.outer(c, y)
        along[..., 2] = z
        origins = np.concatenate([path[:, :2] + ahead, np.full((len(path), 1), mount.z_m)], axis=1)
        reach_m = REACH * self._tof.max_range_m
        fraction, surface, normal = self._arenas.hits(self._trial[self._rows[k]], origins, reach_m * along, path[:, 3])
        toward = -np.einsum("nri,nri->nr", along, normal)
        length_m = reach_m * fraction
        light = cone.profile * toward
        signal = light.sum(axis=1) / cone.full_signal
        light = applied(cone.weighting, light, length_m)
        share = light / np.maximum(light.sum(axis=1, keepdims=True), 1e-12)
        # A ray of length d along u ends where the surface with normal n begins: its derivatives by the place of its
        # origin are n / (-u n), and by a turn about the vertical d n (z x u) / (-u n).
        slope = share / np.where(toward > 0.0, toward, 1.0)
        by_x, by_y = (np.einsum("nr,nr->n", slope, normal[..., i]) for i in (0, 1))
        sideways = normal[..., 1] * along[..., 0] - normal[..., 0] * along[..., 1]
        by_turn = np.einsum("nr,nr->n", slope * length_m, sideways)
        by_yaw = by_turn + by_y * ahead[:, 0] - by_x * ahead[:, 1]
        surfaces = len(self._properties)
        place = np.arange(len(path))[:, None] * surfaces + surface
        shares = np.zeros((len(path), surfaces))
        np.add.at(shares.reshape(-1), place.ravel(), share.ravel())
        distance = np.where(signal > 0.0, cone.head_on * (share * length_m).sum(axis=1), reach_m)
        # Turning the sensor leaves the surfaces where they are and moves the profile of the beam over them.
        sideways_rad = np.arctan2(np.sin(cone.angle_rad) * np.cos(cone.roll_rad), np.cos(cone.angle_rad))
        moves = share * (cone.head_on * length_m - distance[:, None])
        by_profile = moves @ (sideways_rad / np.radians(self._tof.beam_sigma_deg) ** 2)
        by_edge = np.maximum(np.abs(by_profile) - np.abs(cone.head_on * by_turn), 0.0)
        mean_x, mean_y, mean_z = np.einsum("nr,nri->in", share, normal)
        # Axis, left and up of the sensor in the frame of the robot.
        angle, roll = 0.5 * np.pi * np.array([0.0, 1.0, 1.0]), 0.5 * np.pi * np.array([0.0, 0.0, 1.0])
        frame_R = ray_directions(mount, angle, roll, askew_rad)
        return _View(
            distance_m=distance,
            by_pose=cone.head_on * np.stack([by_x, by_y, by_yaw], axis=-1),
            by_edge=by_edge,
            normal=np.stack([c * mean_x + s * mean_y, c * mean_y - s * mean_x, mean_z], axis=-1) @ frame_R.T,
            shares=shares,
            has_target=signal >= self._tof.signal_threshold,
        )


def _numbers(effects: tuple[Effect, ...]) -> Hashable:
    return tuple((type(effect), *vars(effect).values()) for effect in effects)


def _neighbours(effect: Effect) -> Iterator[tuple[float, Effect]]:
    """Yield the points of the grid around an effect with their weights, which add up to 1."""
    near: list[tuple[float, dict[str, float]]] = [(1.0, {})]
    for name, parameter in effect.parameters().items():
        if parameter.is_known:
            continue
        spacing = GRID * parameter.start
        place = getattr(effect, name) / spacing
        below = floor(place)
        ends = [
            (weight, spacing * i) for i, weight in ((below, below + 1 - place), (below + 1, place - below)) if weight
        ]
        near = [(weight * share, {**values, name: value}) for weight, values in near for share, value in ends]
    for weight, values in near:
        yield weight, effect.model_copy(update=values)

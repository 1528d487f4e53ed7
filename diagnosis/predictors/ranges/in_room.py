"""Logged pose -> readings of the three range sensors in an empty room, by a ray along the axis of each."""

from collections.abc import Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from configs.effects.base import Slot
from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.case_format import RANGE_SIDES
from diagnosis.measured.case_files.nominal import NominalDrive
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.room_distances import WALLS, RoomRanges, near_corner, room_ranges
from diagnosis.predictors.base import Covariate, CovariateShape, InputResponse
from diagnosis.predictors.pose.guided_pose import wheel_steps
from diagnosis.predictors.pose.smoothed_pose import NOISE_SHARE
from diagnosis.predictors.pose.tracked_axle import TrackedAxle
from diagnosis.predictors.ranges.base import CORNER_M, CORNER_RAD, END_M, Ranges, Sight, Surroundings
from diagnosis.predictors.ranges.room_errors import WALL_PLACE, corners_m, room_errors, slant, wall_place_m
from diagnosis.predictors.rows import by_other_rows, step_by_other_rows, trial_of_rows
from physics.robot.model import applied
from physics.robot.stack import stacked, stacked_effects
from symolo.core.arrays import Array

WALL_REFLECTANCE = 1.0
NORMALS_RAD = np.array([0.0, np.pi, 0.5 * np.pi, -0.5 * np.pi])
"""Directions of the normals of `WALLS`, which point into the room."""


class RangesInRoom(Ranges):
    """The room, the sensors and the noise of a drive log of the case format."""

    channels = MappingProxyType({f"tof_{sensor}_m": "tof_m" for sensor in RANGE_SIDES})
    # Successive readings share the noise of the poses that are smoothed over their rows.
    correlation = None

    def __init__(self, measurement: Measurement, nominal_case: NominalDrive, nominal: RobotConfig) -> None:
        if nominal_case.tof is None or nominal_case.world is None:
            raise ValueError("a case without range sensors or a room has no such stage")
        self._noise, self._room, self._range = nominal_case.noise, nominal_case.world, nominal_case.tof
        self._trial = trial_of_rows(measurement)
        before = np.arange(len(self._trial)) - 1
        is_first = np.diff(self._trial, prepend=-1) != 0
        self._row_before = np.where(is_first, before + 1, before)
        super().__init__(measurement, nominal)

    def _at_reading_before(self, distance_m: Array) -> Array:
        # Each row of the case format has a reading of its own.
        return distance_m[..., self._row_before, :]

    def _axle_of(self, measurement: Measurement, nominal: RobotConfig) -> TrackedAxle:
        return TrackedAxle(measurement, steps=wheel_steps(measurement, nominal))

    def _changes(self, distance_m: Array, trial: NDArray[np.int64]) -> tuple[Covariate, ...]:
        return (Covariate("distance_step_m", step_by_other_rows(distance_m, trial)),)

    def _around_sensor(self, k: int) -> tuple[Covariate, ...]:
        seen = self._seen_by_other_rows
        place_m, shift = wall_place_m(self._room, seen)[:, k], slant(seen)[:, k]
        return (Covariate(WALL_PLACE, place_m, CovariateShape.OUTLINE, size=shift, corners=corners_m(self._room)),)

    def _unlisted_errors(self) -> tuple[tuple[InputResponse, ...], ...]:
        return room_errors(self._room, self._seen_by_other_rows)

    def _around(self, nominal: RobotConfig) -> Surroundings:
        seen, noise = self._seen([nominal]), self._noise
        # The noise of a row's own pose is in the residual.
        self._seen_by_other_rows = self._seen_from(by_other_rows(self._axle([nominal]), self._trial), [nominal])
        self._pose_variance = (seen.by_x**2 + seen.by_y**2) * noise.pose_xy_m**2
        self._pose_variance += seen.by_yaw**2 * noise.pose_theta_rad**2
        if self._tracked.is_guided:
            self._pose_variance *= NOISE_SHARE**2
        in_reach = seen.distance_m <= self._range.max_range_m - END_M
        clear = in_reach & ~near_corner(self._room, seen, CORNER_M, CORNER_RAD)
        clear &= [getattr(self._range.mount, sensor) is not None for sensor in RANGE_SIDES]
        return Surroundings(clear, seen.wall.astype(float), WALLS)

    def _sight(self, robots: Sequence[RobotConfig]) -> Sight:
        seen = self._seen(robots)
        return Sight(
            distance_m=seen.distance_m,
            reading_m=seen.distance_m,
            sd_m=self._noise.tof.sd_m(seen.distance_m) * robots[0].tof.noise_scale,
            incidence_rad=seen.incidence_rad,
            tilt_forward_rad=np.zeros(len(RANGE_SIDES)),
            tilt_sideways_rad=seen.tilt_rad,
            reflectance=np.full(len(RANGE_SIDES), WALL_REFLECTANCE),
            material_share={},
            pose_variance=self._pose_variance,
            normal_rad=NORMALS_RAD[seen.wall],
        )

    def _seen(self, robots: Sequence[RobotConfig]) -> RoomRanges:
        """Return the ranges of one robot (n, 3), or of M robots (M, n, 3)."""
        return self._seen_from(self._axle(robots), robots)

    def _seen_from(self, axle: Array, robots: Sequence[RobotConfig]) -> RoomRanges:
        """Return the ranges from some poses of the axle, (n, 3) or (M, n, 3)."""
        several, effects = stacked(robots, axes=2), stacked_effects(robots, axes=2)
        mounts = [getattr(several.tof.mounts, sensor) for sensor in RANGE_SIDES]
        x_m, y_m, yaw_deg = (
            _side_by_side([getattr(mount, key) for mount in mounts]) for key in ("x_m", "y_m", "yaw_deg")
        )
        askew = applied(effects.functions(Slot.RANGE_MOUNT), np.zeros(len(RANGE_SIDES)))
        return room_ranges(self._room, axle, x_m, y_m, np.radians(yaw_deg) + askew)


def _side_by_side(values: Sequence[float | Array]) -> Array:
    """Return the values of the three sensors, (3,); (M, 1, 3) if the values of M robots, (M, 1, 1) each, differ."""
    shape = np.broadcast_shapes(*(np.shape(value) for value in values))
    return np.concatenate([np.broadcast_to(np.atleast_1d(value), shape or (1,)) for value in values], axis=-1)

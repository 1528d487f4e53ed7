"""Logged pose -> readings of the three range sensors in an empty room."""

from collections.abc import Sequence

import numpy as np

from configs.effects.base import Slot
from configs.schema.robot import RobotConfig
from diagnosis.measured.channel import Mask
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.nominal import NominalDrive
from diagnosis.predictors.base import Covariate, CovariateShape, Observed, Predicted
from diagnosis.predictors.distinct import distinct
from diagnosis.predictors.pose import earlier
from diagnosis.predictors.room_ranges import WALLS, RoomRanges, near_corner, room_ranges
from diagnosis.predictors.rows import bridged, good_values, joined, session_time_s, trial_covariate, trial_of_rows
from physics.robot.model import through
from physics.robot.stack import alike, stacked, stacked_effects
from sensors.range_effects import RangeEffects
from sensors.range_view import RangeView
from symolo.core.arrays import Array

SENSORS = ("front", "left", "right")
PARTS = ("tof",)
SLOTS = frozenset(
    {
        Slot.POSE_POINT,
        Slot.POSE_DELAY,
        Slot.RANGE_MOUNT,
        Slot.RANGE,
        Slot.RANGE_NOISE,
        Slot.RANGE_LIMIT,
        Slot.RANGE_DELAY,
    }
)
"""Slots of the effects between the logged poses and the readings."""
CORNER_M, CORNER_RAD, END_M = 0.02, 0.05, 0.03
"""Distances from a corner, and from the end of the range, within which a row is left out (case format)."""
WALL_REFLECTANCE = 1.0


class Ranges:
    """Rays from the pose of the axle at the time of the readings, computed from the logged pose and its effects."""

    name = "tof"
    at_once = 48

    def __init__(self, measurement: Measurement, nominal_case: NominalDrive, nominal: RobotConfig) -> None:
        if nominal_case.tof is None or nominal_case.world is None:
            raise ValueError("a case without range sensors or a room has no such stage")
        self._case, self._room, self._mounts = nominal_case, nominal_case.world, nominal_case.tof.mount
        self._trials = [len(trial.t_s) for trial in measurement.trials]
        self._t_s = joined(trial.t_s for trial in measurement.trials)
        self._since_on_s = session_time_s(measurement)
        log = np.stack([good_values(measurement, name) for name in ("x_m", "y_m", "theta_rad")], axis=-1)
        self._log = bridged(log, self._t_s, self._trials)
        seen = self._seen([nominal])
        noise = nominal_case.noise
        self._pose_variance = (seen.by_x**2 + seen.by_y**2) * noise.pose_xy_m**2
        self._pose_variance += seen.by_yaw**2 * noise.pose_theta_rad**2
        mean, sd = self._expected([nominal])
        in_reach = seen.distance_m <= nominal_case.tof.max_range_m - END_M
        clear = in_reach & ~near_corner(self._room, seen, CORNER_M, CORNER_RAD)
        clear &= np.isfinite(log).all(axis=-1, keepdims=True)
        self.observed: tuple[Observed, ...] = tuple(
            self._observed(measurement, k, seen, Predicted(mean[0][:, k], sd[0][:, k]), clear[:, k])
            for k in range(len(SENSORS))
        )

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        several, which = distinct(robots, PARTS, SLOTS)
        mean, sd = self._expected(several)
        return tuple(Predicted(mean[which, :, k], sd[which, :, k]) for k in range(len(SENSORS)))

    def _observed(
        self, measurement: Measurement, k: int, seen: RoomRanges, nominal: Predicted, clear: Mask
    ) -> Observed:
        name = f"tof_{SENSORS[k]}_m"
        values = good_values(measurement, name)
        usable = clear & np.isfinite(values) & (getattr(self._mounts, SENSORS[k]) is not None)
        covariates = (
            Covariate("distance_m", nominal.mean),
            Covariate("incidence_rad", seen.incidence_rad[:, k]),
            Covariate("wall", seen.wall[:, k].astype(float), CovariateShape.CATEGORY, labels=WALLS),
            Covariate("position", self._log[:, 0], second=self._log[:, 1]),
            Covariate("theta_rad", self._log[:, 2], CovariateShape.PERIODIC),
            Covariate("t_s", self._t_s),
            Covariate("session_time_s", self._since_on_s),
            trial_covariate(measurement),
        )
        return Observed(
            name=name,
            channel="tof_m",
            unit="m",
            values=np.where(usable, values, np.nan),
            sd=nominal.sd,
            correlation=0.0,
            trial=trial_of_rows(measurement),
            t_s=self._t_s,
            holdout=joined(t.holdout for t in measurement.trials),
            usable=usable,
            covariates=covariates,
        )

    def _seen(self, robots: Sequence[RobotConfig]) -> RoomRanges:
        """Return the ranges of one robot (n, 3), or of M robots (M, n, 3)."""
        several, effects = stacked(robots, axes=2), stacked_effects(robots, axes=2)
        mounts = [getattr(several.tof.mounts, sensor) for sensor in SENSORS]
        x_m, y_m, yaw_deg = (
            _side_by_side([getattr(mount, key) for mount in mounts]) for key in ("x_m", "y_m", "yaw_deg")
        )
        askew = through(effects.functions(Slot.RANGE_MOUNT), np.zeros(len(SENSORS)))
        return room_ranges(self._room, self._axle(robots), x_m, y_m, np.radians(yaw_deg) + askew)

    def _axle(self, robots: Sequence[RobotConfig]) -> Array:
        """Return the pose of the axle at the times of the readings, (n, 3) or (M, n, 3)."""
        effects = stacked_effects(robots, axes=1)
        range_delay_s = through(effects.functions(Slot.RANGE_DELAY), 0.0)
        pose_delay_s = through(effects.functions(Slot.POSE_DELAY), 0.0, self._t_s)
        # The logged pose is older than its row by the pose delay, the reading by the range delay.
        tracked = earlier(self._log, self._t_s, self._trials, range_delay_s - pose_delay_s)
        point = stacked_effects(robots, axes=2).functions(Slot.POSE_POINT)
        # The effects turn every axle by the same angle and shift it by a vector that depends on its yaw only. So one
        # step back from the tracked pose gives the yaw of the axle, and a second one its place.
        axle = 2.0 * tracked - through(point, tracked)
        return axle + (tracked - through(point, axle))

    def _expected(self, robots: Sequence[RobotConfig]) -> tuple[Array, Array]:
        """Return mean and standard deviation, (M, n, 3) each."""
        mean, sd = (np.empty((len(robots), len(self._t_s), len(SENSORS))) for _ in range(2))
        for group in alike(robots):
            several = [robots[k] for k in group]
            seen, effects, tof = self._seen(several), stacked_effects(several, axes=2), stacked(several, axes=2).tof
            view = RangeView(
                distance_m=seen.distance_m,
                incidence_rad=seen.incidence_rad,
                tilt_forward_rad=np.zeros(len(SENSORS)),
                tilt_sideways_rad=seen.tilt_rad,
                reflectance=np.full(len(SENSORS), WALL_REFLECTANCE),
                material_share={},
                temperature_C=tof.temperature_C,
                reference_temperature_C=tof.reference_temperature_C,
                ambient_lux=tof.ambient_lux,
                time_s=self._since_on_s[:, None],
            )
            bare_sd = self._case.noise.tof.sd_m(seen.distance_m) * tof.noise_scale
            mean[group], reading_sd = RangeEffects.of(effects).expected(seen.distance_m, bare_sd, view, 0.0)
            sd[group] = np.sqrt(reading_sd**2 + self._pose_variance)
        return mean, sd


def _side_by_side(values: Sequence[float | Array]) -> Array:
    """Return the values of the three sensors, (3,); (M, 1, 3) if the values of M robots, (M, 1, 1) each, differ."""
    shape = np.broadcast_shapes(*(np.shape(value) for value in values))
    return np.concatenate([np.broadcast_to(np.atleast_1d(value), shape or (1,)) for value in values], axis=-1)

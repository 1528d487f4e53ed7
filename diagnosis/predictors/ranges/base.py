"""Logged pose -> readings of the three range sensors; a subclass knows what the sensors see."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from configs.effects.base import Slot
from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.case_format import RANGE_SIDES
from diagnosis.measured.channel import Mask
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.base import Covariate, CovariateShape, InputResponse, Observed, Predicted
from diagnosis.predictors.distinct import distinct
from diagnosis.predictors.pose.smoothed_pose import NOISE_SHARE
from diagnosis.predictors.pose.tracked_axle import TrackedAxle
from diagnosis.predictors.rows import (
    by_other_rows,
    good_values,
    joined,
    session_time_s,
    trial_covariate,
    trial_of_rows,
)
from physics.robot.model import applied
from physics.robot.stack import stackable_groups, stacked, stacked_effects
from sensors.ranging.range_effects import RangeEffects
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array

PARTS = ("tof",)
SLOTS = frozenset(
    {
        Slot.POSE_POINT,
        Slot.POSE_HEADING,
        Slot.POSE_DELAY,
        Slot.RANGE_MOUNT,
        Slot.RANGE,
        Slot.RANGE_NOISE,
        Slot.RANGE_LIMIT,
        Slot.RANGE_DELAY,
        Slot.RANGE_GATHERING,
        Slot.RAY_WEIGHT,
    }
)
"""Slots of the effects between the logged poses and the readings."""
SHARED = (1.0 - NOISE_SHARE**2) / (1.0 + NOISE_SHARE**2)
"""Correlation of successive smoothed poses, which have the sum (1 + p)/(1 - p) of those of independent ones. Noise of
the readings themselves only makes it smaller."""
MAX_WAVES = 100.0
"""Largest number of waves along the distance: a cyclic error of a few centimetres repeats that often within a room."""
CORNER_M, CORNER_RAD, END_M = 0.02, 0.05, 0.03
"""Distances from a corner, and from the end of the range, within which a row is left out (case format)."""


@dataclass(frozen=True)
class Sight:
    """What the sensors of a robot, or of M robots, see; all arrays are (n, 3) or (M, n, 3), or broadcast to it."""

    distance_m: Array
    reading_m: Array
    """Reading before the effects."""
    sd_m: Array
    """Standard deviation of its noise before the effects."""
    incidence_rad: Array
    tilt_forward_rad: Array
    """Part of the incidence by which the axis points above the normal of the surface."""
    tilt_sideways_rad: Array
    """Part of the incidence by which the axis points beside it: positive where the left side is further away."""
    reflectance: Array
    material_share: Mapping[str, Array]
    pose_variance: Array
    """Variance of the distance by the noise of the pose [m2]."""
    normal_rad: Array
    """Direction of the normal of the surface in W."""


@dataclass(frozen=True)
class Surroundings:
    """What the nominal robot sees in the rows of a log, beside its ranges; arrays are (n, 3)."""

    clear: Mask
    """Rows in which a reading says something: the sensor sees a surface, and no edge of it."""
    surface: Array
    """Index of the surface that is hit, for most rays."""
    surfaces: tuple[str, ...]
    """Names of the surfaces."""


class Ranges(ABC):
    """Ranges from the pose of the axle at the time of the readings, computed from the logged pose and its effects."""

    name = "tof"
    at_once = 48
    correlation: float | None = 0.0
    """Correlation of the noise of successive readings; None if it must be estimated."""
    resolution_m = 0.0
    """Step to which readings are rounded, if it adds to the stated noise."""
    channels: Mapping[str, str]
    """Name of each range in an answer by that of its channel, in the order of the sensors."""

    def __init__(self, measurement: Measurement, nominal: RobotConfig) -> None:
        self._t_s = joined(trial.t_s for trial in measurement.trials)
        self._since_on_s = session_time_s(measurement)
        self._tracked = self._axle_of(measurement, nominal)
        around = self._around(nominal)
        mean, sd = self._expected([nominal])
        incidence_rad = np.broadcast_to(self._sight([nominal]).incidence_rad, mean.shape)[0]
        clear = around.clear & self._tracked.is_right[:, None]
        errors = self._unlisted_errors() or ((),) * len(RANGE_SIDES)
        self.observed: tuple[Observed, ...] = tuple(
            self._observed(
                measurement,
                name,
                Predicted(mean[0][:, k], sd[0][:, k]),
                clear[:, k],
                (
                    Covariate("incidence_rad", by_other_rows(incidence_rad[:, k], trial_of_rows(measurement))),
                    Covariate("wall", around.surface[:, k], CovariateShape.CATEGORY, labels=around.surfaces),
                    *self._around_sensor(k),
                ),
                errors[k],
            )
            for k, name in enumerate(self.channels)
        )

    @abstractmethod
    def _around(self, nominal: RobotConfig) -> Surroundings:
        """Return what the nominal robot sees beside its ranges."""

    @abstractmethod
    def _sight(self, robots: Sequence[RobotConfig]) -> Sight:
        """Return what robots that can be stacked see."""

    def _around_sensor(self, k: int) -> tuple[Covariate, ...]:
        """Return further covariates for what a sensor sees."""
        del k
        return ()

    def _unlisted_errors(self) -> tuple[tuple[InputResponse, ...], ...]:
        """Return possible errors in no list, by sensor; none by default."""
        return ()

    def _at_reading_before(self, distance_m: Array) -> Array:
        """Return the distances (..., n, 3) at the readings before those of the rows; the present ones if not known."""
        # Rows may repeat a reading until the next one, and those that do not count have no distance.
        return distance_m

    def _changes(self, distance_m: Array, trial: NDArray[np.int64]) -> tuple[Covariate, ...]:
        """Return covariates for how a distance (n,) changes from row to row; none where rows may repeat a reading."""
        del distance_m, trial
        return ()

    def _axle_of(self, measurement: Measurement, nominal: RobotConfig) -> TrackedAxle:
        """Return the logged poses."""
        del nominal
        return TrackedAxle(measurement)

    def _ages_s(self, delay_s: float | Array) -> float | Array:
        """Return the age of the readings when their rows are logged, one or (n,), or (M, 1) or (M, n).

        Args:
            delay_s: Delay of the sensors by effects, one or (M, 1).
        """
        return delay_s

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        several, which = distinct(robots, PARTS, SLOTS)
        mean, sd = self._expected(several)
        return tuple(Predicted(mean[which, :, k], sd[which, :, k]) for k in range(len(RANGE_SIDES)))

    def _observed(  # noqa: PLR0917 - what one sensor reads
        self,
        measurement: Measurement,
        name: str,
        nominal: Predicted,
        clear: Mask,
        around: tuple[Covariate, ...],
        errors: tuple[InputResponse, ...],
    ) -> Observed:
        values = good_values(measurement, name)
        usable = clear & np.isfinite(values)
        x_m, y_m, theta_rad = by_other_rows(self._tracked.pose, trial_of_rows(measurement)).T
        covariates = (
            Covariate("distance_m", by_other_rows(nominal.mean, trial_of_rows(measurement)), max_waves=MAX_WAVES),
            *around,
            *self._changes(nominal.mean, trial_of_rows(measurement)),
            Covariate("position", x_m, second=y_m),
            Covariate("theta_rad", theta_rad, CovariateShape.PERIODIC),
            Covariate("t_s", self._t_s),
            Covariate("session_time_s", self._since_on_s),
            trial_covariate(measurement),
        )
        return Observed(
            name=name,
            channel=self.channels[name],
            unit="m",
            values=np.where(usable, values, np.nan),
            sd=nominal.sd,
            correlation=self.correlation,
            correlation_at_most=SHARED,
            trial=trial_of_rows(measurement),
            t_s=self._t_s,
            holdout=joined(t.holdout for t in measurement.trials),
            usable=usable,
            covariates=covariates,
            input_errors=errors,
        )

    def _axle(self, robots: Sequence[RobotConfig]) -> Array:
        """Return the pose of the axle at the times of the readings, (n, 3) or (M, n, 3)."""
        return self._tracked.at(robots, self._age_s(robots))

    def _age_s(self, robots: Sequence[RobotConfig]) -> float | Array:
        """Return the age of what is read when the rows are logged, one or (n,), or (M, 1) or (M, n)."""
        effects = stacked_effects(robots, axes=1)
        age_s = self._ages_s(applied(effects.functions(Slot.RANGE_DELAY), 0.0))
        # A mean over the time before a reading is about the range in the middle of it.
        return age_s + 0.5 * applied(effects.functions(Slot.RANGE_GATHERING), 0.0)

    def _expected(self, robots: Sequence[RobotConfig]) -> tuple[Array, Array]:
        """Return mean and standard deviation, (M, n, 3) each."""
        mean, sd = (np.empty((len(robots), len(self._t_s), len(RANGE_SIDES))) for _ in range(2))
        for group in stackable_groups(robots):
            several = [robots[k] for k in group]
            sight, effects, tof = self._sight(several), stacked_effects(several, axes=2), stacked(several, axes=2).tof
            view = RangeView(
                distance_m=sight.distance_m,
                previous_distance_m=self._at_reading_before(sight.distance_m),
                incidence_rad=sight.incidence_rad,
                tilt_forward_rad=sight.tilt_forward_rad,
                tilt_sideways_rad=sight.tilt_sideways_rad,
                reflectance=sight.reflectance,
                material_share=sight.material_share,
                temperature_C=tof.temperature_C,
                reference_temperature_C=tof.reference_temperature_C,
                ambient_lux=tof.ambient_lux,
                time_s=self._since_on_s[:, None],
                sensor=np.arange(len(RANGE_SIDES)),
                normal_rad=sight.normal_rad,
            )
            reading = RangeEffects.from_effects(effects).expected(sight.reading_m, sight.sd_m, view, self.resolution_m)
            mean[group], reading_sd = reading
            sd[group] = np.sqrt(reading_sd**2 + sight.pose_variance)
        return mean, sd

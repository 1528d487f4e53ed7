"""Logged pose -> readings of the eight line channels over the line of a known arena."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from math import ceil

import numpy as np
from numpy.typing import NDArray

from configs.effects.base import Slot
from configs.effects.robot_effects import RobotEffects
from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.nominal import NominalLog
from diagnosis.measured.case_files.symolo_columns import LINE_READINGS
from diagnosis.measured.channel import Mask
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.base import Covariate, Observed, Predicted
from diagnosis.predictors.distinct import distinct
from diagnosis.predictors.pose.smoothed_pose import NOISE_SHARE
from diagnosis.predictors.pose.tracked_axle import TrackedAxle
from diagnosis.predictors.ranges.unit_spread import Cleaned, cleaned
from diagnosis.predictors.rows import by_other_rows, good_values, joined, trial_of_rows
from physics.robot.model import applied
from sensors.line.line_sensor import LineOptics, tape_share
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array

MOVING = frozenset({Slot.POSE_POINT, Slot.POSE_HEADING, Slot.POSE_DELAY, Slot.LINE_PLACE, Slot.LINE_HEIGHT})
"""Slots of the effects that move the spots on the floor."""
SLOTS = MOVING | {Slot.LINE_READING, Slot.LINE_LIMIT}
FLOOR_SD, TAPE_SD = 0.05, 0.03
"""Tolerances of the reflectances of floor and tape: shipped scenarios draw them for each run."""
MAX_ROWS = 500
"""Largest number of rows that are predicted, evenly spaced. The eight channels of 500 rows are 4000 samples, more than
all other stages have, and more rows would take longer."""
SHARED = 0.5
"""Correlation that stands for the noise of the pose which readings share: successive rows by the smoothing, and the
channels on the two edges of the line. Each reading then counts as a third of an independent one."""
OFF_PERIOD = 1e-6
"""Distance of a time from a multiple of a period, in periods, by rounding."""
AT_LIMIT = 2.0
"""Distance of a reading from the limit of the converter, in sigmas of its noise, up to which it may be at the limit."""
LIMIT_ROUNDS = 3
"""Repetitions by which the readings beyond the limit are known."""
_NODES, _WEIGHTS = np.polynomial.hermite_e.hermegauss(31)


@dataclass(frozen=True)
class _Readings:
    """Readings of one robot; arrays are (rows, 8)."""

    mean: Array
    free: Array
    """Readings of a converter without limits."""
    limits: tuple[float, float]
    """Smallest and largest reading."""
    sd: Array
    ink: Array
    """Shares of the spots on the tape."""
    level: float
    """Light relative to that at the specified height."""
    by_tolerances: float = 0.0
    """Sum of the squares of gains, offsets and reflectances in tolerances."""


class LineReadings:
    """Shares of the spots on the tape from the pose of the axle, as the simulated sensor has them.

    The poses are smoothed. What is left of their noise blurs the edges of the line: the mean is that of a wider spot,
    and the noise of a reading is largest on an edge.
    """

    name = "line"
    at_once = 48

    def __init__(self, measurement: Measurement, case: NominalLog, nominal: RobotConfig) -> None:
        self._arena, self._sensor = Arena.from_config(case.arena), nominal.line_sensor
        noise = case.noise
        self._reading_sd = float(np.hypot(noise.line, 2.0**-self._sensor.adc_bits / np.sqrt(12.0)))
        self._place_sd_m = NOISE_SHARE * float(np.hypot(noise.pose_xy_m, self._sensor.x_m * noise.pose_theta_rad))
        self._tracked = TrackedAxle(measurement, is_smoothed=True)
        rows = len(self._tracked.is_logged)
        self._age_s = _age_s(measurement, self._sensor.period_s, self._sensor.delay_s)
        self._known: dict[Hashable, Array] = {}
        self._rows = np.arange(rows)
        reflectance = by_other_rows(self._expected(nominal).mean, trial_of_rows(measurement))
        self._known.clear()
        step = max(1, -(-rows // MAX_ROWS))
        self._rows = np.arange(0, rows, step)
        trial = trial_of_rows(measurement)[self._rows]
        self._runs = [np.flatnonzero(trial == number) for number in np.unique(trial).tolist()]
        holdout = joined(t.holdout for t in measurement.trials)[self._rows]
        t_s = joined(t.t_s for t in measurement.trials)[self._rows]
        values = np.stack([good_values(measurement, name)[self._rows] for name in LINE_READINGS], axis=-1)
        usable = self._tracked.is_logged[self._rows, None] & np.isfinite(values)
        self._values = np.where(usable, values, np.nan)
        self._fitted, self._heldout = usable & ~holdout[:, None], usable & holdout[:, None]
        bare = self._expected(nominal)
        self.observed: tuple[Observed, ...] = tuple(
            Observed(
                name=name,
                channel=column,
                unit="1",
                values=self._values[:, k],
                sd=bare.sd[:, k],
                correlation=SHARED,
                trial=trial,
                t_s=t_s,
                holdout=holdout,
                usable=usable[:, k],
                covariates=(Covariate("reflectance", reflectance[self._rows, k]), Covariate("t_s", t_s)),
                samples="rows" if step == 1 else f"rows, one of {step} successive ones,",
            )
            for k, (name, column) in enumerate(LINE_READINGS.items())
        )

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        several, which = distinct(robots, ("line_sensor",), SLOTS)
        readings = [self._unit_readings(self._expected(robot)) for robot in several]
        mean, sd = (np.stack([getattr(each, name) for each in readings])[which] for name in ("mean", "sd"))
        by_tolerances = np.array([each.by_tolerances for each in readings])[which]
        # The tolerances of floor and tape belong to all channels together, and their cost is that of the first one.
        return tuple(
            Predicted(mean[..., k], sd[..., k], by_tolerances if k == 0 else None) for k in range(len(LINE_READINGS))
        )

    def _unit_readings(self, expected: "_Readings") -> "_Readings":
        """Return the readings of the unit that was measured, with its own gains and offsets on its own floor.

        These are known from what was measured. They are such that the residuals are those without the tolerances
        (`unit_spread`). A reading at a limit says only that the unit is beyond the limit.
        """
        mean, by_tolerances = expected.mean.copy(), 0.0
        for rows in self._runs:
            known, numbers = self._unit_readings_of_run(expected, rows)
            mean[rows] = np.where(np.isfinite(known), known, expected.mean[rows])
            by_tolerances += float(numbers @ numbers)
        return replace(expected, mean=mean, by_tolerances=by_tolerances)

    def _unit_readings_of_run(self, expected: "_Readings", rows: NDArray[np.int64]) -> tuple[Array, Array]:
        """Return the readings of the unit in the rows of a run, NaN where none was measured, and its numbers (18,)."""
        (low, high), near = expected.limits, AT_LIMIT * self._reading_sd
        values, free, sd = self._values[rows], expected.free[rows], expected.sd[rows]
        off = (values - free) / sd
        spread = (self._spread(expected, rows) / sd[..., None]).reshape(off.size, -1)
        at_low, at_high = values <= low + near, values >= high - near

        def judged(unit: Array) -> tuple[Mask, Cleaned, Array]:
            beyond = (at_low & (unit <= low)) | (at_high & (unit >= high))
            fitted, heldout = ((which[rows] & ~beyond).ravel() for which in (self._fitted, self._heldout))
            result = cleaned(spread, off.ravel(), fitted, heldout)
            return beyond, result, free + sd * (spread @ result.numbers).reshape(off.shape)

        beyond, result, unit = judged(free)
        for _ in range(LIMIT_ROUNDS if (at_low | at_high).any() else 0):
            beyond, result, unit = judged(unit)
        return np.where(beyond, np.clip(unit, low, high), values - sd * result.z.reshape(off.shape)), result.numbers

    def _spread(self, expected: "_Readings", rows: NDArray[np.int64]) -> Array:
        """Return the change of readings in some rows by one tolerance of each number, (rows, 8, 18)."""
        each, ink = np.eye(len(LINE_READINGS)), expected.ink[rows]
        gains = self._sensor.gain_sd * expected.free[rows, :, None] * each
        offsets = np.broadcast_to(self._sensor.offset_sd * each, gains.shape)
        surfaces = expected.level * np.stack([FLOOR_SD * (1.0 - ink), TAPE_SD * ink], axis=-1)
        return np.concatenate([gains, offsets, surfaces], axis=-1)

    def _expected(self, robot: RobotConfig) -> "_Readings":
        """Return the readings of a robot without tolerances."""
        optics, effects = LineOptics.from_config(self._sensor, robot.effects), robot.effects
        ink = self._ink(robot, optics)
        reading = applied(effects.functions(Slot.LINE_READING), optics.light(ink, self._arena))
        limits = effects.functions(Slot.LINE_LIMIT)
        low, high = applied(limits, np.array([0.0, 1.0])).tolist()
        mean = applied(limits, np.clip(reading, 0.0, 1.0))
        contrast = optics.level * abs(self._arena.line.reflectance - self._arena.floor_reflectance)
        sd = np.hypot(self._reading_sd, contrast * self._edge_sd(ink, optics.spot_sd_m))
        return _Readings(mean, reading, (low, high), sd, ink, optics.level)

    def _ink(self, robot: RobotConfig, optics: LineOptics) -> Array:
        """Return the mean shares (rows, 8) of the spots on the tape."""
        moving = robot.effects.in_slots(MOVING)
        key = tuple((type(effect), *vars(effect).values()) for effect in moving)
        if key not in self._known:
            there = robot.model_copy(update={"effects": RobotEffects(moving)})
            x, y, yaw = self._tracked.at([there], self._age_s)[self._rows].T
            c, s = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
            ahead, left = self._sensor.x_m, optics.place_m
            points = np.stack([x[:, None] + c * ahead - s * left, y[:, None] + s * ahead + c * left], axis=-1)
            blurred_m = float(np.hypot(optics.spot_sd_m, self._place_sd_m))
            self._known[key] = tape_share(self._arena.line, points.reshape(-1, 2), blurred_m).reshape(len(x), -1)
        return self._known[key]

    def _edge_sd(self, ink: Array, spot_sd_m: float) -> Array:
        """Return the standard deviation of shares by the noise of the pose, by their means (rows, 8).

        On one edge, the share of a spot at a distance u is Phi(u / s), and its mean over the noise q of the smoothed
        place is Phi(u / hypot(s, q)), so that the distance follows from the mean.
        """
        from scipy.special import ndtr  # noqa: PLC0415 - as in sensors.line.line_sensor

        u = np.linspace(-4.0, 4.0, 81) * np.hypot(spot_sd_m, self._place_sd_m)
        squares = ndtr((u[:, None] + self._place_sd_m * _NODES) / max(spot_sd_m, 1e-6)) ** 2
        mean = ndtr(u / np.hypot(spot_sd_m, self._place_sd_m))
        variance = squares @ (_WEIGHTS / _WEIGHTS.sum()) - mean**2
        return np.sqrt(np.maximum(np.interp(ink, mean, variance), 0.0))


def _age_s(measurement: Measurement, period_s: float, delay_s: float) -> float:
    """Return the mean age of a reading when its row is logged.

    The log does not say when the sensor samples. If its period divides the times between rows, it is as old in each
    row, and a sensor that was switched on with the log samples at the rows.
    """
    periods = np.concatenate([np.diff(trial.t_s) for trial in measurement.trials]) / period_s
    if np.all(np.abs(periods - np.rint(periods)) < OFF_PERIOD):
        return ceil(delay_s / period_s - OFF_PERIOD) * period_s
    return delay_s + 0.5 * period_s

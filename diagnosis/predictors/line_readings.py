"""Logged pose -> readings of the eight line channels over the line of a known arena."""

from collections.abc import Hashable, Sequence

import numpy as np
from numpy.typing import NDArray

from configs.effects.base import Slot
from configs.effects.robot_effects import RobotEffects
from configs.schema.robot import RobotConfig
from diagnosis.measured.channel import Mask
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.nominal import NominalLog
from diagnosis.measured.symolo_columns import LINE_READINGS
from diagnosis.predictors.base import Covariate, Observed, Predicted
from diagnosis.predictors.distinct import distinct
from diagnosis.predictors.rows import good_values, joined, trial_of_rows
from diagnosis.predictors.tracked_axle import TrackedAxle
from diagnosis.predictors.unit_spread import UnitSpread
from physics.robot.model import through
from sensors.line_sensor import LineOptics, tape_share
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array

MOVING = frozenset({Slot.POSE_POINT, Slot.POSE_DELAY, Slot.LINE_PLACE, Slot.LINE_HEIGHT})
"""Slots of the effects that move the spots on the floor."""
SLOTS = MOVING | {Slot.LINE_READING, Slot.LINE_LIMIT}
FLOOR_SD, TAPE_SD = 0.05, 0.03
"""Tolerances of the reflectances of floor and tape: shipped scenarios draw them for each run."""
MAX_ROWS = 500
"""Greatest number of rows that are predicted, evenly spaced. The eight channels of 500 rows are 4000 samples, more than
all other stages have, and more rows would take longer."""
_NODES, _WEIGHTS = np.polynomial.hermite_e.hermegauss(31)


class LineReadings:
    """Shares of the spots on the tape from the pose of the axle, as the simulated sensor has them.

    The noise of the pose blurs the edges of the line: the mean is that of a wider spot, and the noise of a reading is
    largest on an edge.
    """

    name = "line"
    at_once = 48

    def __init__(self, measurement: Measurement, case: NominalLog, nominal: RobotConfig) -> None:
        self._arena, self._sensor = Arena.from_config(case.arena), nominal.line_sensor
        noise = case.noise
        self._reading_sd = float(np.hypot(noise.line, 2.0**-self._sensor.adc_bits / np.sqrt(12.0)))
        self._place_sd_m = float(np.hypot(noise.pose_xy_m, self._sensor.x_m * noise.pose_theta_rad))
        self._tracked = TrackedAxle(measurement)
        rows = len(self._tracked.is_logged)
        self._rows = np.arange(0, rows, max(1, -(-rows // MAX_ROWS)))
        self._known: dict[Hashable, Array] = {}
        self._spreads: list[tuple[NDArray[np.int64], UnitSpread]] = []
        self._nominal, sd = (array[0] for array in self._expected([nominal]))
        self._sd = sd.copy()
        self._ink_of_nominal = self._ink(nominal, LineOptics.of(self._sensor, nominal.effects))
        trial, holdout = trial_of_rows(measurement)[self._rows], joined(t.holdout for t in measurement.trials)
        t_s = joined(t.t_s for t in measurement.trials)[self._rows]
        values = np.stack([good_values(measurement, name)[self._rows] for name in LINE_READINGS], axis=-1)
        usable = self._tracked.is_logged[self._rows, None] & np.isfinite(values)
        self._spreads = [
            self._spread(values, np.flatnonzero(trial == number), usable, holdout[self._rows, None])
            for number in np.unique(trial).tolist()
        ]
        cleaned = self._cleaned(values)
        observed = []
        for k, (name, column) in enumerate(LINE_READINGS.items()):
            observed.append(
                Observed(
                    name=name,
                    channel=column,
                    unit="1",
                    values=np.where(usable[:, k], cleaned[:, k], np.nan),
                    sd=sd[:, k],
                    correlation=0.0,
                    trial=trial,
                    t_s=t_s,
                    holdout=holdout[self._rows],
                    usable=usable[:, k],
                    covariates=(Covariate("reflectance", self._nominal[:, k]), Covariate("t_s", t_s)),
                )
            )
        self.observed: tuple[Observed, ...] = tuple(observed)

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        several, which = distinct(robots, ("line_sensor",), SLOTS)
        mean, sd = self._expected(several)
        cleaned = self._cleaned(mean)
        return tuple(Predicted(cleaned[which, :, k], sd[which, :, k]) for k in range(len(LINE_READINGS)))

    def _spread(
        self, values: Array, rows: NDArray[np.int64], usable: Mask, holdout: Mask
    ) -> tuple[NDArray[np.int64], UnitSpread]:
        """Return the rows of one run, and the spread of its readings by gains, offsets, floor and tape.

        Args:
            values: (N, 8), readings of all runs.
            rows: (n,), indices of the rows of the run.
            usable: (N, 8), readings that can be compared.
            holdout: (N, 1), rows that are held out.
        """
        mean, sd = self._nominal[rows], self._sd[rows]
        each = np.eye(len(LINE_READINGS))
        # One column for the gain and one for the offset of each channel, (rows, 8, 8) each, one for floor and tape.
        gains = self._sensor.gain_sd * mean[..., None] * each
        offsets = np.broadcast_to(self._sensor.offset_sd * each, gains.shape)
        floor = FLOOR_SD * (1.0 - self._ink_of_nominal[rows, :, None])
        tape = TAPE_SD * self._ink_of_nominal[rows, :, None]
        spread = np.concatenate([gains, offsets, floor, tape], axis=-1) / sd[..., None]
        residuals = (values[rows] - mean) / sd
        fitted, heldout = ((usable & which)[rows].ravel() for which in (~holdout, holdout))
        return rows, UnitSpread.of(spread.reshape(-1, spread.shape[-1]), residuals.ravel(), fitted, heldout)

    def _cleaned(self, readings: Array) -> Array:
        """Return readings (..., rows, 8) without the tolerances of gains, offsets and floor."""
        cleaned = np.array(readings)
        for rows, spread in self._spreads:
            mean, sd = self._nominal[rows], self._sd[rows]
            off = np.nan_to_num((readings[..., rows, :] - mean) / sd)
            flat = spread.without(off.reshape(*off.shape[:-2], -1))
            cleaned[..., rows, :] = mean + sd * flat.reshape(off.shape)
        return cleaned

    def _expected(self, robots: Sequence[RobotConfig]) -> tuple[Array, Array]:
        """Return mean and standard deviation, (M, rows, 8) each."""
        both = [self._of_robot(robot) for robot in robots]
        return np.stack([mean for mean, _ in both]), np.stack([sd for _, sd in both])

    def _of_robot(self, robot: RobotConfig) -> tuple[Array, Array]:
        optics, effects = LineOptics.of(self._sensor, robot.effects), robot.effects
        ink = self._ink(robot, optics)
        reading = through(effects.functions(Slot.LINE_READING), optics.light(ink, self._arena))
        mean = through(effects.functions(Slot.LINE_LIMIT), np.clip(reading, 0.0, 1.0))
        contrast = optics.level * abs(self._arena.line.reflectance - self._arena.floor_reflectance)
        return mean, np.hypot(self._reading_sd, contrast * self._edge_sd(ink, optics.spot_sd_m))

    def _ink(self, robot: RobotConfig, optics: LineOptics) -> Array:
        """Return the mean shares (rows, 8) of the spots on the tape."""
        moving = robot.effects.in_slots(MOVING)
        key = tuple((type(effect), *vars(effect).values()) for effect in moving)
        if key not in self._known:
            there = robot.model_copy(update={"effects": RobotEffects(moving)})
            x, y, yaw = self._tracked.at([there], self._sensor.delay_s + 0.5 * self._sensor.period_s)[self._rows].T
            c, s = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
            ahead, left = self._sensor.x_m, optics.place_m
            points = np.stack([x[:, None] + c * ahead - s * left, y[:, None] + s * ahead + c * left], axis=-1)
            blurred_m = float(np.hypot(optics.spot_sd_m, self._place_sd_m))
            self._known[key] = tape_share(self._arena.line, points.reshape(-1, 2), blurred_m).reshape(len(x), -1)
        return self._known[key]

    def _edge_sd(self, ink: Array, spot_sd_m: float) -> Array:
        """Return the standard deviation of shares by the noise of the pose, by their means (rows, 8).

        On one edge, the share of a spot at a distance u is Phi(u / s), and its mean over the noise p of the place is
        Phi(u / hypot(s, p)), so that the distance follows from the mean.
        """
        from scipy.special import ndtr  # noqa: PLC0415 - as in sensors.line_sensor

        u = np.linspace(-4.0, 4.0, 81) * np.hypot(spot_sd_m, self._place_sd_m)
        squares = ndtr((u[:, None] + self._place_sd_m * _NODES) / max(spot_sd_m, 1e-6)) ** 2
        mean = ndtr(u / np.hypot(spot_sd_m, self._place_sd_m))
        variance = squares @ (_WEIGHTS / _WEIGHTS.sum()) - mean**2
        return np.sqrt(np.maximum(np.interp(ink, mean, variance), 0.0))

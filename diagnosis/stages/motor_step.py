"""Voltage -> current and speed of a motor against time, from rest at the start of each trial."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from configs.errors import InputError
from configs.schema.robot import RobotConfig
from diagnosis.measured.channel import Array
from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.measured.nominal import NominalStep
from diagnosis.measured.screening import GAP, usual
from diagnosis.stages.base import Covariate, Observed, Predicted, Shape, Stage
from diagnosis.stages.rows import joined, observed_channel
from physics.motor_bench import step_responses
from physics.robot_model import RobotModel
from physics.robot_stack import alike, stacked, stacked_terms
from sensors.instruments import read_current_A, read_speed_rad_s

OFF_GRID = 0.25
"""Periods, root mean square, at which the rows of a log are not on the grid of a rate: a quarter is half a period off,
evenly spread, less rounding."""


class MotorStep:
    """All trials of a log side by side on one grid of samples, one period apart from rest at time 0.

    Over samples that the log lacks, and where a voltage is missing, the one before is held.

    Raises:
        InputError: Two rows of a trial fall on the same sample.
    """

    name = "motor"

    def __init__(self, measurement: Measurement, nominal: RobotConfig) -> None:
        trials = measurement.trials
        self._period_s = _period_s(measurement)
        self._places = [_places(trial, self._period_s, measurement) for trial in trials]
        samples = max(1, *(int(place[-1]) for place in self._places)) + 1
        held = [_held(trial, place, samples) for trial, place in zip(trials, self._places, strict=True)]
        self._voltage_V = np.stack(held, axis=1)
        self._begins_s = np.array([trial.begins_s or 0.0 for trial in trials])
        current, speed = (of[0] for of in self._means([nominal]))
        voltage_V = self._of_rows(self._voltage_V)
        since_s, angle_rad = self._of_rows(self._since_step_s()), self._of_rows(self._angle_rad(speed))
        since_start_s = joined(trial.t_s for trial in trials)
        trial_of = joined(np.full(len(trial.t_s), float(k)) for k, trial in enumerate(trials))
        covariates = (
            Covariate("t_s", since_start_s),
            Covariate("time_since_step_s", since_s),
            Covariate("omega_rad_s", speed),
            Covariate("current_A", current),
            Covariate("u_cmd_V", voltage_V),
            Covariate("angle_rad", angle_rad, Shape.PERIODIC),
            Covariate("session_time_s", since_start_s + self._begins_s[trial_of.astype(int)]),
            Covariate("trial", trial_of, Shape.CATEGORY, labels=tuple(trial.name for trial in trials)),
        )
        everywhere = np.ones(len(voltage_V), dtype=bool)
        self.observed: tuple[Observed, ...] = tuple(
            observed_channel(measurement, name, everywhere, covariates) for name in ("current_A", "omega_rad_s")
        )

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        return tuple(Predicted(mean, of.sd) for mean, of in zip(self._means(robots), self.observed, strict=True))

    def _means(self, robots: Sequence[RobotConfig]) -> tuple[Array, Array]:
        rows = sum(len(place) for place in self._places)
        current, speed = np.empty((len(robots), rows)), np.empty((len(robots), rows))
        t_s = self._period_s * np.arange(len(self._voltage_V))
        for group in alike(robots):
            several = [robots[k] for k in group]
            model, terms = RobotModel.from_config(stacked(several, axes=2)), stacked_terms(several, axes=1)
            moving = step_responses(model, self._voltage_V[1:], self._period_s, self._begins_s)
            # Robots that differ in what their instruments say alone share one motion.
            each = (of if of.ndim > self._voltage_V.ndim else of[:, None] for of in moving)
            amperes, rad_s = (np.concatenate([np.zeros_like(of[:1]), of]) for of in each)
            current[group] = self._of_rows(read_current_A(terms, amperes))
            speed[group] = self._of_rows(read_speed_rad_s(terms, t_s, rad_s))
        return current, speed

    def _of_rows(self, samples: Array) -> Array:
        """Samples (T, ..., N) at the rows of all trials, (..., n)."""
        return np.concatenate([samples[place, ..., k].T for k, place in enumerate(self._places)], axis=-1)

    def _since_step_s(self) -> Array:
        """Time since the voltage last changed, (T, N); it was 0 V up to time 0."""
        number = np.arange(len(self._voltage_V))[:, None]
        changes = np.diff(self._voltage_V, axis=0, prepend=0.0) != 0.0
        # A voltage is held over the period that ends at its sample, and so began one sample earlier.
        return self._period_s * (number - np.maximum.accumulate(np.where(changes, number - 1, 0)))

    def _angle_rad(self, speed_rad_s: Array) -> Array:
        """Turned since the start of each trial by the speeds of its rows (n,), between them on lines; (T, N)."""
        number, begin = np.arange(len(self._voltage_V)), 0
        columns = []
        for place in self._places:
            of_trial = speed_rad_s[begin : begin + len(place)]
            known = np.interp(number, np.append(0, place), np.append(0.0, of_trial))
            columns.append(self._period_s * np.append(0.0, np.cumsum(0.5 * (known[1:] + known[:-1]))))
            begin += len(place)
        return np.stack(columns, axis=1)


def motor_step_stages(measurement: Measurement, nominal: RobotConfig) -> tuple[Stage, ...]:
    """The one stage of the bench."""
    return (MotorStep(measurement, nominal),)


def _period_s(measurement: Measurement) -> float:
    """Of the log: that of the nominal rate where the rows are on its grid, else the one that fits them.

    Times of a log are rounded, so that the usual step would drift away from the rows.
    """
    t_s = np.concatenate([trial.t_s for trial in measurement.trials])
    if isinstance(measurement.nominal, NominalStep):
        places = t_s * measurement.nominal.sample_rate_Hz
        if np.sqrt(np.mean((places - np.rint(places)) ** 2)) < OFF_GRID:
            return 1.0 / measurement.nominal.sample_rate_Hz
    return _fitted_period_s(measurement.trials)


def _fitted_period_s(trials: tuple[Trial, ...]) -> float:
    """Slope of times over sample numbers by least squares, each trial with a start of its own.

    The first row's time where no trial has two rows.
    """
    steps = np.concatenate([np.diff(trial.t_s) for trial in trials])
    if not len(steps):
        return float(trials[0].t_s[0]) or 1.0
    period_s = float(steps[steps <= GAP * usual(steps)].mean())
    products = squares = 0.0
    for trial in trials:
        number = np.concatenate([[0.0], np.cumsum(np.maximum(np.rint(np.diff(trial.t_s) / period_s), 1.0))])
        number -= number.mean()
        products += float(number @ trial.t_s)
        squares += float(number @ number)
    return products / squares


def _places(trial: Trial, period_s: float, measurement: Measurement) -> NDArray[np.int64]:
    """Of each row on the grid, (N,); the state at rest is 0."""
    place = np.maximum(np.rint(trial.t_s / period_s).astype(np.int64), 0)
    same = np.flatnonzero(np.diff(place) == 0).tolist()
    if same:
        first, second = trial.t_s[same[0] : same[0] + 2].tolist()
        raise InputError(
            f"column t_s: {first:.10g} and {second:.10g} of trial {trial.name} fall on the same sample",
            where=next(iter(measurement.source.files), measurement.name),
            allowed=f"samples {period_s:.6g} s apart",
            cure="keep one of the two rows, and check the rate",
        )
    return place


def _held(trial: Trial, place: NDArray[np.int64], samples: int) -> Array:
    """Voltage over the period that ends at each sample, (samples,); 0 V up to the first that is known."""
    voltage = np.full(samples, np.nan)
    voltage[place] = trial["u_cmd_V"].values
    known = np.isfinite(voltage)
    last = np.maximum.accumulate(np.where(known, np.arange(samples), -1))
    return np.where(last >= 0, voltage[last], 0.0)

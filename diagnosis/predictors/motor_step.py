"""Voltage -> current and speed of a motor against time, from rest at the start of each trial."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.nominal import NominalStep
from diagnosis.predictors.base import Covariate, CovariateShape, Observed, Predicted, Stage
from diagnosis.predictors.grid import Grid
from diagnosis.predictors.rows import given, joined, observed_channel
from physics.drivetrain.motor_bench import step_responses
from physics.robot.model import RobotModel
from physics.robot.stack import alike, stacked, stacked_effects
from sensors.instruments import read_current_A, read_speed_rad_s
from symolo.core.arrays import Array


class MotorStep:
    """All trials of a log side by side on one grid of samples, one period apart from rest at time 0.

    Over samples that the log lacks, and where a voltage is missing, the one before is held.

    Raises:
        InputError: Two rows of a trial fall on the same sample.
    """

    name = "motor"
    at_once = 256

    def __init__(self, measurement: Measurement, nominal: RobotConfig) -> None:
        trials = measurement.trials
        rate_hz = measurement.nominal.sample_rate_Hz if isinstance(measurement.nominal, NominalStep) else None
        self._grid = Grid.of(measurement, rate_hz)
        self._voltage_V = self._grid.held(trials, "u_cmd_V")
        current, speed = (of[0] for of in self._means([nominal]))
        voltage_V = self._grid.of_rows(self._voltage_V)
        since_s, step_V = (self._grid.of_rows(of) for of in self._since_step())
        measured = given(measurement, "omega_rad_s")
        angle_rad = self._grid.of_rows(self._angle_rad(np.where(np.isfinite(measured), measured, speed)))
        since_start_s = joined(trial.t_s for trial in trials)
        trial_of = joined(np.full(len(trial.t_s), float(k)) for k, trial in enumerate(trials))
        covariates = (
            Covariate("t_s", since_start_s),
            Covariate("time_since_step_s", since_s, CovariateShape.SINCE, size=step_V),
            Covariate("omega_rad_s", speed),
            Covariate("current_A", current),
            Covariate("u_cmd_V", voltage_V),
            Covariate("angle_rad", angle_rad, CovariateShape.PERIODIC),
            Covariate("session_time_s", since_start_s + self._grid.begins_s[trial_of.astype(int)]),
            Covariate("trial", trial_of, CovariateShape.CATEGORY, labels=tuple(trial.name for trial in trials)),
        )
        everywhere = np.ones(len(voltage_V), dtype=bool)
        # A gear that is cut badly changes the speed by a share, but the torque by an amount.
        of_speed = tuple(replace(of, size=speed) if of.name == "angle_rad" else of for of in covariates)
        self.observed: tuple[Observed, ...] = (
            observed_channel(measurement, "current_A", everywhere, covariates),
            observed_channel(measurement, "omega_rad_s", everywhere, of_speed),
        )

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        return tuple(Predicted(mean, of.sd) for mean, of in zip(self._means(robots), self.observed, strict=True))

    def _means(self, robots: Sequence[RobotConfig]) -> tuple[Array, Array]:
        rows = sum(len(place) for place in self._grid.places)
        current, speed = np.empty((len(robots), rows)), np.empty((len(robots), rows))
        trials = self._voltage_V.shape[1]
        t_s = self._grid.period_s * np.arange(len(self._voltage_V))
        for group in alike(robots):
            several = [robots[k] for k in group]
            model = RobotModel.from_config(stacked(several, axes=2, times=trials))
            effects = stacked_effects(several, axes=1)
            moving = step_responses(model, self._voltage_V[1:], self._grid.period_s, self._grid.begins_s)
            # Robots that differ in what their instruments say alone share one motion.
            each = (of if of.ndim > self._voltage_V.ndim else of[:, None] for of in moving)
            amperes, rad_s = (np.concatenate([np.zeros_like(of[:1]), of]) for of in each)
            current[group] = self._grid.of_rows(read_current_A(effects, amperes))
            speed[group] = self._grid.of_rows(read_speed_rad_s(effects, t_s, rad_s))
        return current, speed

    def _since_step(self) -> tuple[Array, Array]:
        """Time since the voltage last changed, and by how much it did, (T, N) each; it was 0 V up to time 0."""
        number = np.arange(len(self._voltage_V))[:, None]
        steps_V = np.diff(self._voltage_V, axis=0, prepend=0.0)
        last = np.maximum.accumulate(np.where(steps_V != 0.0, number, -1))
        size_V = np.where(last >= 0, np.take_along_axis(steps_V, np.maximum(last, 0), axis=0), 0.0)
        # A voltage is held over the period that ends at its sample, and so began one sample earlier.
        return self._grid.period_s * (number - np.maximum(last - 1, 0)), size_V

    def _angle_rad(self, speed_rad_s: Array) -> Array:
        """Turned since the start of each trial by the speeds of its rows (n,), between them on lines; (T, N)."""
        number, begin = np.arange(len(self._voltage_V)), 0
        columns = []
        for place in self._grid.places:
            of_trial = speed_rad_s[begin : begin + len(place)]
            known = np.interp(number, np.append(0, place), np.append(0.0, of_trial))
            columns.append(self._grid.period_s * np.append(0.0, np.cumsum(0.5 * (known[1:] + known[:-1]))))
            begin += len(place)
        return np.stack(columns, axis=1)


def motor_step_stages(measurement: Measurement, nominal: RobotConfig) -> tuple[Stage, ...]:
    """The one stage of the bench."""
    return (MotorStep(measurement, nominal),)

"""Voltage -> current and speed of a motor against time, from rest at the start of each trial."""

import numpy as np
from numpy.typing import NDArray

from configs.errors import InputError
from configs.schema.robot import RobotConfig
from diagnosis.measured.channel import Array
from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.measured.nominal import NominalStep
from diagnosis.measured.screening import GAP, usual
from diagnosis.stages.base import Prediction, predicted
from physics.motor_bench import step_responses
from physics.robot_model import RobotModel
from sensors.instruments import read_current_A, read_speed_rad_s

OFF_GRID = 0.25
"""Periods, root mean square, at which the rows of a log are not on the grid of a rate: a quarter is half a period off,
evenly spread, less rounding."""


def predict_motor_step(measurement: Measurement, robot: RobotConfig) -> tuple[Prediction, ...]:
    """`current_A` and `omega_rad_s` at each row from the `u_cmd_V` of all rows up to it.

    The trials run side by side on one grid of samples, one period of the log apart from rest at time 0. Over samples
    that the log lacks, and where a voltage is missing, the one before is held.

    Raises:
        InputError: Two rows of a trial fall on the same sample.
    """
    trials = measurement.trials
    period_s = _period_s(measurement)
    places = [_places(trial, period_s, measurement) for trial in trials]
    samples = max(1, *(int(place[-1]) for place in places)) + 1
    voltage = np.stack([_held(trial, place, samples) for trial, place in zip(trials, places, strict=True)], axis=1)
    begins_s = np.array([trial.begins_s or 0.0 for trial in trials])
    moving = step_responses(RobotModel.from_config(robot), voltage[1:], period_s, begins_s)
    current, speed = (np.concatenate([np.zeros_like(of[:1]), of]) for of in moving)
    current = read_current_A(robot.terms, current)
    speed = read_speed_rad_s(robot.terms, period_s * np.arange(samples), speed)
    return tuple(
        (
            predicted(trial, "current_A", "A", current[place, k]),
            predicted(trial, "omega_rad_s", "rad/s", speed[place, k]),
        )
        for k, (trial, place) in enumerate(zip(trials, places, strict=True))
    )


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

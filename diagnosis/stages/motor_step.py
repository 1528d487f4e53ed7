"""Voltage -> current and speed of a motor against time, from rest at the start of each trial."""

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from diagnosis.measured.channel import Array
from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.measured.screening import usual
from diagnosis.stages.base import Prediction, predicted
from physics.motor_bench import step_responses
from physics.robot_model import RobotModel
from sensors.instruments import read_current_A, read_speed_rad_s


def predict_motor_step(measurement: Measurement, robot: RobotConfig) -> tuple[Prediction, ...]:
    """`current_A` and `omega_rad_s` at each row from the `u_cmd_V` of all rows up to it.

    The trials run side by side on one grid of rows, one period of the log apart, the first a period after rest. Over
    rows that the log lacks, and where a voltage is missing, the one before is held.
    """
    trials = measurement.trials
    period_s = _period_s(trials)
    places = [_places(trial, period_s) for trial in trials]
    rows = max(int(place[-1]) for place in places) + 1
    voltage = np.stack([_held(trial, place, rows) for trial, place in zip(trials, places, strict=True)], axis=1)
    begins_s = np.array([trial.begins_s or 0.0 for trial in trials])
    current, speed = step_responses(RobotModel.from_config(robot), voltage, period_s, begins_s)
    current = read_current_A(robot.terms, current)
    speed = read_speed_rad_s(robot.terms, period_s * np.arange(1, rows + 1), speed)
    return tuple(
        (
            predicted(trial, "current_A", "A", current[place, k]),
            predicted(trial, "omega_rad_s", "rad/s", speed[place, k]),
        )
        for k, (trial, place) in enumerate(zip(trials, places, strict=True))
    )


def _period_s(trials: tuple[Trial, ...]) -> float:
    """Of the log: the usual step, or the first row's time where no trial has two rows."""
    steps = np.concatenate([np.diff(trial.t_s) for trial in trials])
    return usual(steps) if len(steps) else float(trials[0].t_s[0])


def _places(trial: Trial, period_s: float) -> NDArray[np.int64]:
    """Of each row on the grid, (N,); that at one period after rest is 0."""
    return np.maximum(np.rint(trial.t_s / period_s).astype(np.int64) - 1, 0)


def _held(trial: Trial, place: NDArray[np.int64], rows: int) -> Array:
    """Voltage over each row of the grid, (rows,), which ends at it; 0 V up to the first that is known."""
    voltage = np.full(rows, np.nan)
    voltage[place] = trial["u_cmd_V"].values
    known = np.isfinite(voltage)
    last = np.maximum.accumulate(np.where(known, np.arange(rows), -1))
    return np.where(last >= 0, voltage[last], 0.0)

"""Voltage -> current and speed of a motor that has settled, as current sensor and tachometer of the bench say them."""

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.stages.base import Prediction, predicted
from physics.motor_bench import steady_states
from physics.robot_model import RobotModel
from sensors.instruments import read_current_A, read_settled_speed_rad_s


def predict_motor_steady(measurement: Measurement, robot: RobotConfig) -> tuple[Prediction, ...]:
    """`current_A` and `omega_rad_s` of each row from its `u_cmd_V` and the time since the motor was switched on."""
    model = RobotModel.from_config(robot)
    return tuple(_of_trial(trial, model, robot) for trial in measurement.trials)


def _of_trial(trial: Trial, model: RobotModel, robot: RobotConfig) -> Prediction:
    voltage = trial["u_cmd_V"].values
    given = np.isfinite(voltage)
    since_on_s = trial.t_s + (trial.begins_s or 0.0) if trial.is_timed else np.zeros_like(trial.t_s)
    current, speed = np.full_like(voltage, np.nan), np.full_like(voltage, np.nan)
    current[given], speed[given] = steady_states(model, voltage[given], since_on_s[given])
    return (
        predicted(trial, "current_A", "A", read_current_A(robot.terms, current)),
        predicted(trial, "omega_rad_s", "rad/s", read_settled_speed_rad_s(robot.terms, speed)),
    )

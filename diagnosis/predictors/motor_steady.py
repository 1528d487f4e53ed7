"""Voltage -> current and speed of a motor in steady state, as the instruments of the bench measure them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.predictors.base import Covariate, CovariateShape, Observed, Predicted
from diagnosis.predictors.rows import good_values, joined, observed_channel, trial_of_rows
from physics.drivetrain.motor_bench import steady_states
from physics.robot.model import RobotModel
from physics.robot.stack import alike, stacked, stacked_effects
from sensors.instruments import read_current_A, read_settled_speed_rad_s
from symolo.core.arrays import Array
from symolo.core.errors import InputError

NEAR_BREAKAWAY = 2.2
"""Multiple of the breakaway voltage up to which rows are not used: a small change of friction decides whether the wheel
moves at all, so such a row contains little about a running motor. `evidence.stuck_rows` uses them."""


class MotorSteady:
    """All rows of a bench at once.

    Raises:
        InputError: No row has a voltage.
    """

    name = "motor"
    at_once = 48

    def __init__(self, measurement: Measurement, nominal: RobotConfig) -> None:
        trials = measurement.trials
        if not any(channel.is_offered for channel in measurement.across("u_cmd_V")):
            raise InputError(
                "no row has a voltage at the motor, without which current and speed cannot be predicted",
                where=measurement.where,
                cure="log that voltage, or the battery's voltage and the duty cycle",
            )
        self._voltage_V = joined(trial["u_cmd_V"].values for trial in trials)
        supply_V = good_values(measurement, "supply_V")
        self._supply_V = supply_V if np.isfinite(supply_V).any() else None
        self._since_on_s = joined(_since_on_s(trial) for trial in trials)
        self._known = np.isfinite(self._voltage_V)
        if self._supply_V is not None:
            self._known &= np.isfinite(self._supply_V)
        current, speed = (mean[0] for mean in self._means([nominal]))
        motor = nominal.motor
        breakaway_V = motor.winding_resistance_ohm * motor.coulomb_friction_N_m / motor.torque_constant_N_m_A
        size_V = np.abs(self._voltage_V)
        clear = self._known & ((size_V == 0.0) | (size_V > NEAR_BREAKAWAY * breakaway_V))
        covariates = (
            Covariate("omega_rad_s", speed),
            Covariate("current_A", current),
            Covariate("u_cmd_V", self._voltage_V),
            Covariate("t_s", self._since_on_s),
            Covariate("sweep", trial_of_rows(measurement).astype(float), CovariateShape.CATEGORY),
        )
        self.observed: tuple[Observed, ...] = tuple(
            replace(observed_channel(measurement, name, clear, covariates), is_series=False)
            for name in ("current_A", "omega_rad_s")
        )

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        return tuple(
            Predicted(mean, observed.sd) for mean, observed in zip(self._means(robots), self.observed, strict=True)
        )

    def _means(self, robots: Sequence[RobotConfig]) -> tuple[Array, Array]:
        current, speed = (np.full((len(robots), len(self._known)), np.nan) for _ in range(2))
        for group in alike(robots):
            several = [robots[k] for k in group]
            model = RobotModel.from_config(stacked(several, axes=2))
            effects = stacked_effects(several, axes=1)
            known = self._known
            supply_V = None if self._supply_V is None else self._supply_V[known]
            amperes, rad_s = steady_states(model, self._voltage_V[known], self._since_on_s[known], supply_V)
            place = np.ix_(np.array(group), np.flatnonzero(known))
            current[place] = read_current_A(effects, amperes)
            speed[place] = read_settled_speed_rad_s(effects, rad_s)
        return current, speed


def _since_on_s(trial: Trial) -> Array:
    return trial.t_s + (trial.begins_s or 0.0) if trial.is_timed else np.zeros_like(trial.t_s)

"""Voltage -> current and speed of a motor that has settled, as current sensor and tachometer of the bench say them."""

from collections.abc import Sequence

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.predictors.base import Covariate, CovariateShape, Observed, Predicted, Stage
from diagnosis.predictors.rows import joined, observed_channel
from physics.drivetrain.motor_bench import steady_states
from physics.robot.model import RobotModel
from physics.robot.stack import alike, stacked, stacked_effects
from sensors.instruments import read_current_A, read_settled_speed_rad_s
from symolo.core.arrays import Array
from symolo.core.errors import InputError

NEAR_BREAKAWAY = 2.2
"""Breakaway voltages up to which a small change of friction decides whether the wheel moves at all: such a row says
much of a stuck wheel and little of a running one, so that it is left to the reading of stuck and moving rows."""


class MotorSteady:
    """All rows of a bench at once."""

    name = "motor"
    at_once = 48

    def __init__(self, measurement: Measurement, nominal: RobotConfig) -> None:
        trials = measurement.trials
        self._voltage_V = joined(trial["u_cmd_V"].values for trial in trials)
        self._since_on_s = joined(_since_on_s(trial) for trial in trials)
        self._given = np.isfinite(self._voltage_V)
        current, speed = (of[0] for of in self._means([nominal]))
        motor = nominal.motor
        breakaway_V = motor.winding_resistance_ohm * motor.coulomb_friction_N_m / motor.torque_constant_N_m_A
        size_V = np.abs(self._voltage_V)
        clear = self._given & ((size_V == 0.0) | (size_V > NEAR_BREAKAWAY * breakaway_V))
        covariates = (
            Covariate("omega_rad_s", speed),
            Covariate("current_A", current),
            Covariate("u_cmd_V", self._voltage_V),
            Covariate("t_s", self._since_on_s),
            Covariate(
                "sweep", joined(np.full(len(t.t_s), float(k)) for k, t in enumerate(trials)), CovariateShape.CATEGORY
            ),
        )
        self.observed: tuple[Observed, ...] = tuple(
            observed_channel(measurement, name, clear, covariates) for name in ("current_A", "omega_rad_s")
        )

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        return tuple(Predicted(mean, of.sd) for mean, of in zip(self._means(robots), self.observed, strict=True))

    def _means(self, robots: Sequence[RobotConfig]) -> tuple[Array, Array]:
        current, speed = (np.full((len(robots), len(self._given)), np.nan) for _ in range(2))
        for group in alike(robots):
            several = [robots[k] for k in group]
            model = RobotModel.from_config(stacked(several, axes=2))
            effects = stacked_effects(several, axes=1)
            amperes, rad_s = steady_states(model, self._voltage_V[self._given], self._since_on_s[self._given])
            given = np.ix_(np.array(group), np.flatnonzero(self._given))
            current[given] = read_current_A(effects, amperes)
            speed[given] = read_settled_speed_rad_s(effects, rad_s)
        return current, speed


def _since_on_s(trial: Trial) -> Array:
    return trial.t_s + (trial.begins_s or 0.0) if trial.is_timed else np.zeros_like(trial.t_s)


def motor_steady_stages(measurement: Measurement, nominal: RobotConfig) -> tuple[Stage, ...]:
    """The one stage of the bench.

    Raises:
        InputError: No row has a voltage.
    """
    if not any(channel.is_offered for channel in measurement.across("u_cmd_V")):
        raise InputError(
            "no row has a voltage at the motor, by which alone current and speed can be predicted",
            where=next(iter(measurement.source.files), measurement.name),
            cure="log that voltage, or the battery's beside the duty",
        )
    return (MotorSteady(measurement, nominal),)

"""Voltage -> current and speed of a motor in steady state, as the instruments of the bench measure them.

Near the voltage at which a motor starts, a small change of its friction decides whether it turns. So the readings of a
row are predicted for what was seen in it: the current of a motor that stands still is u / R, and that of one that turns
follows from its speed. Whether it turns is evidence of its own: no motor starts at exactly the same torque each time,
so that a row has a probability of it (logistic regression: McCullagh and Nelder, Generalized Linear Models, 2nd ed.,
chapter 4). Its deviance residual is added to the prediction of the speed.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from configs.effects.robot_effects import RobotEffects
from configs.schema.robot import RobotConfig
from diagnosis.measured.channel import Mask
from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.predictors.base import Covariate, CovariateShape, Observed, Predicted
from diagnosis.predictors.rows import good_values, joined, observed_channel, trial_of_rows
from physics.drivetrain.motor_bench import RowHistory, steady_states, steady_states_of_known_motion
from physics.robot.model import RobotModel
from physics.robot.stack import stackable_groups, stacked, stacked_effects
from sensors.wheels.instruments import read_current_A, read_settled_speed_rad_s
from symolo.core.arrays import Array
from symolo.core.errors import InputError

NEAR_BREAKAWAY = 2.2
"""Multiple of the breakaway voltage up to which a row is not used if nobody knows whether the motor turned in it."""
BREAKAWAY_SPREAD = 0.05
"""Scale of the logistic distribution of the torque at which a motor starts, as a share of its friction at rest."""
STILL, TURNING = 3.0, 6.0
"""Speed readings in standard deviations of their noise, below which a motor stands still and above which it turns, of
an instrument that does not read exactly 0 at rest."""


STEP_DECIMALS = 6
"""Digits to which a step of the voltage is rounded [V]."""


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
        self._turns = np.zeros(len(self._known), dtype=bool)
        self._is_seen = np.zeros(len(self._known), dtype=bool)
        self._speed_sd_rad_s = np.zeros(len(self._known))
        current, speed = (mean[0] for mean in self._means([nominal]))
        motor = nominal.motor
        breakaway_V = motor.winding_resistance_ohm * motor.coulomb_friction_N_m / motor.torque_constant_N_m_A
        size_V = np.abs(self._voltage_V)
        self.is_far = self._known & ((size_V == 0.0) | (size_V > NEAR_BREAKAWAY * breakaway_V))
        """(n,), rows with a voltage at which a motor surely turns, or none."""
        step_V = joined(_size_step(trial["u_cmd_V"].values) for trial in trials)
        covariates = (
            Covariate("omega_rad_s", speed),
            Covariate("current_A", current),
            Covariate("u_cmd_V", self._voltage_V),
            *([Covariate("voltage_step_V", step_V)] if len(np.unique(step_V[np.isfinite(step_V)])) > 1 else []),
            Covariate("t_s", self._since_on_s),
            Covariate("sweep", trial_of_rows(measurement).astype(float), CovariateShape.CATEGORY),
        )
        measured = good_values(measurement, "omega_rad_s")
        everywhere = observed_channel(measurement, "omega_rad_s", self._known, covariates)
        self._speed_sd_rad_s = everywhere.sd
        self._is_seen, self._turns = _seen(measured, everywhere.sd, self._voltage_V, self.is_far)
        self._is_seen &= self._known
        usable = self.is_far | self._is_seen
        # Without a voltage a motor stands still for certain, which says nothing.
        of_speed = np.where(self._is_seen, size_V > 0.0, self.is_far)
        stands = self._is_seen & ~self._turns
        self.observed: tuple[Observed, ...] = tuple(
            replace(observed_channel(measurement, name, rows, covariates), is_series=False, is_state=states)
            for name, rows, states in (("current_A", usable, None), ("omega_rad_s", usable & of_speed, stands))
        )

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        return tuple(
            Predicted(mean, observed.sd) for mean, observed in zip(self._means(robots), self.observed, strict=True)
        )

    def _means(self, robots: Sequence[RobotConfig]) -> tuple[Array, Array]:
        current, speed = (np.full((len(robots), len(self._known)), np.nan) for _ in range(2))
        for group in stackable_groups(robots):
            several = [robots[k] for k in group]
            model = RobotModel.from_config(stacked(several, axes=2))
            effects = stacked_effects(several, axes=1)
            past = RowHistory.of(model, self._voltage_V, self._since_on_s)
            for rows, states in ((self._known & ~self._is_seen, self._from_rest), (self._is_seen, self._as_seen)):
                if rows.any():
                    place = np.ix_(np.array(group), np.flatnonzero(rows))
                    current[place], speed[place] = states(model, effects, rows, past.of_rows(rows))
        return current, speed

    def _from_rest(self, model: RobotModel, effects: RobotEffects, rows: Mask, past: RowHistory) -> tuple[Array, Array]:
        """Return the readings of current and speed (M, k) in rows of which nobody knows whether the motor turns."""
        voltage_V, since_on_s, supply_V = self._inputs(rows)
        amperes, rad_s = steady_states(model, voltage_V, since_on_s, supply_V, past)
        return read_current_A(effects, amperes, since_on_s), read_settled_speed_rad_s(effects, rad_s, since_on_s)

    def _as_seen(self, model: RobotModel, effects: RobotEffects, rows: Mask, past: RowHistory) -> tuple[Array, Array]:
        """Return the readings of current and speed (M, k) in rows of which it is known whether the motor turns."""
        voltage_V, since_on_s, supply_V = self._inputs(rows)
        turns = self._turns[rows]
        seen = steady_states_of_known_motion(model, voltage_V, since_on_s, turns, supply_V, past)
        chance = np.logaddexp(0.0, np.where(turns, -1.0, 1.0) * seen.surplus / BREAKAWAY_SPREAD)
        # A motor that turns although it should stand still seems too fast, and too slow the other way round.
        surprise = np.where(turns, -1.0, 1.0) * np.sign(voltage_V) * np.sqrt(2.0 * chance) * self._speed_sd_rad_s[rows]
        speed = read_settled_speed_rad_s(effects, seen.speed_rad_s, since_on_s)
        return read_current_A(effects, seen.current_A, since_on_s), speed + surprise

    def _inputs(self, rows: Mask) -> tuple[Array, Array, Array | None]:
        """Return voltages, times and supply voltages of some rows."""
        supply_V = None if self._supply_V is None else self._supply_V[rows]
        return self._voltage_V[rows], self._since_on_s[rows], supply_V


def _seen(speed_rad_s: Array, sd_rad_s: Array, voltage_V: Array, is_far: Mask) -> tuple[Mask, Mask]:
    """Return in which rows (n,) it is known whether the motor turns, and in which it does.

    Args:
        speed_rad_s: (n,), measured speeds, NaN where there is none.
        sd_rad_s: (n,), standard deviation of their noise.
        voltage_V: (n,), voltages.
        is_far: (n,), rows with a voltage at which the speed of a motor that turns would be seen.
    """
    if np.any(speed_rad_s == 0.0):
        return np.isfinite(speed_rad_s), np.isfinite(speed_rad_s) & (speed_rad_s != 0.0)
    along = speed_rad_s * np.sign(voltage_V)
    turns = along > TURNING * sd_rad_s
    # Near the voltage at which it starts, a motor may turn so slowly that the noise hides it.
    return turns | (is_far & (np.abs(speed_rad_s) < STILL * sd_rad_s)), turns


def _since_on_s(trial: Trial) -> Array:
    return trial.t_s + (trial.begins_s or 0.0) if trial.is_timed else np.zeros_like(trial.t_s)


def _size_step(voltage_V: Array) -> Array:
    """Return by how much the size of the voltage has grown since the row before, (n,); NaN in the first row."""
    # Steps that differ in their last digits only are equal.
    step_V = np.full(len(voltage_V), np.nan)
    step_V[1:] = np.diff(np.abs(voltage_V))
    return step_V.round(STEP_DECIMALS)

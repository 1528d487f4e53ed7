"""Voltage -> current and speed of a motor in steady state, as the instruments of the bench measure them.

Near the voltage at which a motor starts, a small change of its friction decides whether it turns. So the readings of a
row are predicted for what was seen in it: the current of a motor that stands still is u / R, and that of one that turns
follows from its speed. Whether it turns is evidence of its own: no motor starts at exactly the same torque each time,
so that a row has a probability of it (logistic regression: McCullagh and Nelder, Generalized Linear Models, 2nd ed.,
chapter 4). Its deviance residual is added to the prediction of the speed.

Where the noise of the instrument hides whether the motor turns, its current is (u - K w) / R all the same, with the
measured speed w, whose noise adds to that of the current. For the speed, the more probable of two explanations counts:
the motor turns as slowly as the model says, or it stands still by chance.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from configs.effects.robot_effects import RobotEffects
from configs.schema.robot import RobotConfig
from diagnosis.measured.channel import Mask
from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.predictors.base import Covariate, CovariateShape, Observed, Predicted
from diagnosis.predictors.motor.seen_motion import seen_motion
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
        self._speed_rad_s = np.full(len(self._known), np.nan)
        self._speed_sd_rad_s = np.zeros(len(self._known))
        self._motion = seen_motion(self._speed_rad_s, self._speed_sd_rad_s, self._voltage_V)
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
        self._speed_rad_s = np.where(self._known, good_values(measurement, "omega_rad_s"), np.nan)
        speed_channel = observed_channel(measurement, "omega_rad_s", self._known, covariates)
        self._speed_sd_rad_s = speed_channel.sd
        self._motion = motion = seen_motion(self._speed_rad_s, speed_channel.sd, self._voltage_V)
        usable = self.is_far | motion.is_seen
        # Without a voltage a motor stands still for certain, which says nothing.
        speed_channel = observed_channel(measurement, "omega_rad_s", usable & (size_V > 0.0), covariates)
        current_channel = observed_channel(measurement, "current_A", usable, covariates)
        amperes_per_rad_s = np.where(motion.is_hidden, motor.torque_constant_N_m_A / motor.winding_resistance_ohm, 0.0)
        self.observed: tuple[Observed, ...] = (
            replace(
                current_channel, is_series=False, sd=np.hypot(current_channel.sd, amperes_per_rad_s * speed_channel.sd)
            ),
            replace(speed_channel, is_series=False, is_state=motion.stands | motion.is_hidden),
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
            past = RowHistory.from_commands(model, self._voltage_V, self._since_on_s)
            is_seen = self._motion.is_seen
            for rows, states in ((self._known & ~is_seen, self._from_rest), (is_seen, self._as_seen)):
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
        turns, is_hidden = self._motion.turns[rows], self._motion.is_hidden[rows]
        measured = np.where(is_hidden, self._speed_rad_s[rows], np.nan)
        seen = steady_states_of_known_motion(model, voltage_V, since_on_s, turns, supply_V, past, measured)
        chance = np.logaddexp(0.0, np.where(turns, -1.0, 1.0) * seen.surplus / BREAKAWAY_SPREAD)
        # A motor that turns although it should stand still seems too fast, and too slow the other way round.
        surprise = np.where(turns, -1.0, 1.0) * np.sign(voltage_V) * np.sqrt(2.0 * chance) * self._speed_sd_rad_s[rows]
        speed = read_settled_speed_rad_s(effects, seen.speed_rad_s, since_on_s) + surprise
        if is_hidden.any():
            _, slow = self._from_rest(model, effects, rows, past)
            # The reading of a motor at rest is noise, beside the surprise that it is at rest.
            at_rest = np.hypot(measured, surprise)
            is_slow = np.abs(measured - slow) < at_rest
            speed = np.where(is_hidden, np.where(is_slow, slow, measured + np.sign(voltage_V) * at_rest), speed)
        return read_current_A(effects, seen.current_A, since_on_s), speed

    def _inputs(self, rows: Mask) -> tuple[Array, Array, Array | None]:
        """Return voltages, times and supply voltages of some rows."""
        supply_V = None if self._supply_V is None else self._supply_V[rows]
        return self._voltage_V[rows], self._since_on_s[rows], supply_V


def _since_on_s(trial: Trial) -> Array:
    return trial.t_s + (trial.begins_s or 0.0) if trial.is_timed else np.zeros_like(trial.t_s)


def _size_step(voltage_V: Array) -> Array:
    """Return by how much the size of the voltage has grown since the row before, (n,); NaN in the first row."""
    # Steps that differ in their last digits only are equal.
    step_V = np.full(len(voltage_V), np.nan)
    step_V[1:] = np.diff(np.abs(voltage_V))
    return step_V.round(STEP_DECIMALS)

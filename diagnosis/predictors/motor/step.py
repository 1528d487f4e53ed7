"""Voltage -> current and speed of a motor against time, starting at rest in each trial."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from configs.effects.base import Slot
from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.nominal import NominalStep
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.base import SESSION_TIME, Covariate, CovariateShape, InputResponse, Observed, Predicted
from diagnosis.predictors.distinct import KnownPredictions
from diagnosis.predictors.grid import Grid
from diagnosis.predictors.motor.inductance import INDUCTANCE, TIME_CONSTANTS, inductive_motions
from diagnosis.predictors.rows import good_values, joined, observed_channel, trial_covariate, trial_of_rows
from diagnosis.predictors.turning_response import TurningResponse
from physics.drivetrain.motion import voltage_trend
from physics.drivetrain.motor_bench import step_responses
from physics.robot.model import RobotModel
from physics.robot.stack import MOTOR_TORQUE_SLOTS, stackable_groups, stacked, stacked_effects
from sensors.wheels.instruments import read_current_A, read_speed_rad_s
from symolo.core.arrays import Array

PARTS = ("motor", "power")
SLOTS = MOTOR_TORQUE_SLOTS | {Slot.MOTORS, Slot.COMMAND_DELAY, Slot.ACTUATOR, Slot.BATTERY, Slot.GEARBOX}
"""Slots of the effects on the motion; those of the instruments act on its readings."""

INPUT_ERROR = 0.01
"""Error of the voltage, as a share, at which the responses to it are computed."""


class MotorStep:
    """All trials of a log side by side on a regular grid of samples, at rest at time 0.

    At samples without a row or a voltage, the voltage before is held.

    Raises:
        InputError: Two rows of a trial fall on the same sample.
    """

    name = "motor"
    at_once = 256

    def __init__(self, measurement: Measurement, nominal: RobotConfig) -> None:
        trials = measurement.trials
        rate_hz = measurement.nominal.sample_rate_Hz if isinstance(measurement.nominal, NominalStep) else None
        self._grid = Grid.from_measurement(measurement, rate_hz)
        self._voltage_V = self._grid.zero_order_hold(trials, "u_cmd_V")
        self._known = KnownPredictions(PARTS, SLOTS, self._motions)
        current, speed = (mean[0] for mean in self._means([nominal]))
        input_errors = [a + b for a, b in zip(self._input_errors(nominal), self._inductances(nominal), strict=True)]
        voltage_V = self._grid.of_rows(self._voltage_V)
        since_s, step_V = (self._grid.of_rows(samples) for samples in self._since_step())
        measured = good_values(measurement, "omega_rad_s")
        angle_rad = self._grid.of_rows(self._angle_rad(np.where(np.isfinite(measured), measured, speed)))
        since_start_s = joined(trial.t_s for trial in trials)
        covariates = (
            Covariate("t_s", since_start_s),
            Covariate("time_since_step_s", since_s, CovariateShape.SINCE, size=step_V),
            Covariate("omega_rad_s", speed),
            Covariate("current_A", current),
            Covariate("u_cmd_V", voltage_V),
            Covariate("angle_rad", angle_rad, CovariateShape.PERIODIC),
            Covariate(SESSION_TIME, since_start_s + self._grid.begins_s[trial_of_rows(measurement)]),
            trial_covariate(measurement),
        )
        everywhere = np.ones(len(voltage_V), dtype=bool)
        by_current, by_speed = self._responses(measurement, nominal, angle_rad, speed)
        # An irregular gear changes the speed in proportion, but the torque by a fixed amount.
        current_covariates, speed_covariates = (
            tuple(replace(c, size=size, response=response) if c.name == "angle_rad" else c for c in covariates)
            for size, response in ((None, by_current), (speed, by_speed))
        )
        self.observed: tuple[Observed, ...] = tuple(
            replace(
                observed_channel(measurement, name, everywhere, covariates), input_errors=errors, numbers_may_drift=True
            )
            for name, covariates, errors in zip(
                ("current_A", "omega_rad_s"), (current_covariates, speed_covariates), input_errors, strict=True
            )
        )

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        return tuple(
            Predicted(mean, observed.sd) for mean, observed in zip(self._means(robots), self.observed, strict=True)
        )

    def _means(self, robots: Sequence[RobotConfig]) -> tuple[Array, Array]:
        return self._read(robots, self._known.predictions(robots))

    def _read(self, robots: Sequence[RobotConfig], motions: Array) -> tuple[Array, Array]:
        """Return the readings of currents and speeds (M, n) from the true ones at all samples, (M, 2, T, N)."""
        rows = sum(len(place) for place in self._grid.places)
        current, speed = np.empty((len(robots), rows)), np.empty((len(robots), rows))
        t_s = self._grid.period_s * np.arange(len(self._voltage_V))
        since_on_s = t_s[:, None, None] + self._grid.begins_s
        for group in stackable_groups(robots):
            effects = stacked_effects([robots[k] for k in group], axes=1)
            amperes, rad_s = (np.moveaxis(motions[group, k], 0, 1) for k in range(2))
            current[group] = self._grid.of_rows(read_current_A(effects, amperes, since_on_s))
            speed[group] = self._grid.of_rows(read_speed_rad_s(effects, t_s, rad_s, since_on_s))
        return current, speed

    def _motions(self, robots: Sequence[RobotConfig]) -> Array:
        """Return true currents [A] and speeds [rad/s] at all samples, (M, 2, T, N)."""
        motions = np.empty((len(robots), 2, *self._voltage_V.shape))
        for group in stackable_groups(robots):
            trials = len(self._grid.begins_s)
            model = RobotModel.from_config(stacked([robots[k] for k in group], axes=2, lengths=(trials,)))
            motions[group] = self._moved(model, self._voltage_V, self._grid.begins_s)
        return motions

    def _moved(self, model: RobotModel, voltage_V: Array, begins_s: Array) -> Array:
        """Return the same by M times as many voltages as the log has, (T, N) or (T, M N), from rest at time 0."""
        samples, trials = self._voltage_V.shape
        moving = step_responses(model, voltage_V[1:], self._grid.period_s, begins_s)
        rows = [np.moveaxis(motion.reshape(samples - 1, -1, trials), 1, 0) for motion in moving]
        return np.pad(np.stack(rows, axis=1), ((0, 0), (0, 0), (1, 0), (0, 0)))

    def _input_errors(self, nominal: RobotConfig) -> tuple[tuple[InputResponse, ...], ...]:
        """Return errors of the voltage with the responses of current and speed to them.

        Its gain may be wrong, may drift over the session, or may be greater after a rise of the voltage than after a
        fall.
        """
        samples, trials = self._voltage_V.shape
        session_s = self._grid.period_s * np.arange(samples)[:, None] + self._grid.begins_s
        errors = {
            ("u_cmd_V", "gain of the voltage"): np.ones((samples, trials)),
            ("u_cmd_V", "gain of the voltage that depends on rise or fall"): voltage_trend(self._voltage_V),
            (SESSION_TIME, "gain of the voltage that drifts"): session_s / max(float(session_s.max()), 1e-9),
        }
        # Both ways, so that a dead zone of the motor is not on one side only.
        factors = [1.0 + size * share for share in errors.values() for size in (INPUT_ERROR, -INPUT_ERROR)]
        voltage_V = np.concatenate([self._voltage_V * factor for factor in factors], axis=1)
        model = RobotModel.from_config(stacked([nominal], axes=2, lengths=(voltage_V.shape[1],)))
        motions = self._moved(model, voltage_V, np.tile(self._grid.begins_s, len(factors)))
        return tuple(
            tuple(InputResponse(*key, change) for key, change in zip(errors, each[::2] - each[1::2], strict=True))
            for each in self._read([nominal] * len(factors), motions)
        )

    def _inductances(self, nominal: RobotConfig) -> tuple[tuple[InputResponse, ...], ...]:
        """Return the responses of current and speed to inductances of the winding."""
        model = RobotModel.from_config(nominal)
        stacked_model = RobotModel.from_config(
            stacked([nominal], axes=2, lengths=(len(TIME_CONSTANTS) * len(self._grid.begins_s),))
        )
        begins_s = np.tile(self._grid.begins_s, len(TIME_CONSTANTS))
        motions = inductive_motions(
            model.motors.right,
            self._voltage_V,
            self._grid.period_s,
            lambda voltage_V: self._moved(stacked_model, voltage_V, begins_s),
            self._motions([nominal])[0],
        )
        changes = zip(self._read([nominal] * len(motions), motions), self._means([nominal]), strict=True)
        return tuple(
            tuple(InputResponse("time_since_step_s", INDUCTANCE, change, chosen=1) for change in read - nominal_read)
            for read, nominal_read in changes
        )

    def _responses(
        self, measurement: Measurement, nominal: RobotConfig, angle_rad: Array, speed_rad_s: Array
    ) -> tuple[TurningResponse, TurningResponse]:
        """Return the responses of current and speed to a torque that depends on the angle.

        Args:
            measurement: The log.
            nominal: The nominal robot.
            angle_rad: (n,), angle at the rows.
            speed_rad_s: (n,), predicted speed, which shows without noise which rows are at rest.
        """
        motor = RobotModel.from_config(nominal).motors.right
        trial = trial_of_rows(measurement)
        turned = np.diff(angle_rad, prepend=0.0)
        turned[(np.diff(trial, prepend=-1) != 0) | (speed_rad_s == 0.0)] = 0.0
        slower = 1.0 / motor.damping_N_m_s_rad
        common = {
            "angle_rad": angle_rad - 0.5 * turned,
            "turned_rad": turned,
            "trial": trial,
            "time_constant_s": motor.inertia_kg_m2 * slower,
            "period_s": self._grid.period_s,
        }
        speed_response = TurningResponse(scale=-slower, **common)
        return replace(
            speed_response, scale=slower * motor.torque_constant_N_m_A / motor.resistance_ohm
        ), speed_response

    def _since_step(self) -> tuple[Array, Array]:
        """Return time since the last change of the voltage, and its size, (T, N) each; it is 0 V before time 0."""
        number = np.arange(len(self._voltage_V))[:, None]
        steps_V = np.diff(self._voltage_V, axis=0, prepend=0.0)
        last = np.maximum.accumulate(np.where(steps_V != 0.0, number, -1))
        size_V = np.where(last >= 0, np.take_along_axis(steps_V, np.maximum(last, 0), axis=0), 0.0)
        # A voltage is held over the period that ends at its sample, so it began one sample earlier.
        return self._grid.period_s * (number - np.maximum(last - 1, 0)), size_V

    def _angle_rad(self, speed_rad_s: Array) -> Array:
        """Return the angle (T, N) since the start of each trial, from the interpolated speeds of its rows (n,)."""
        number, begin = np.arange(len(self._voltage_V)), 0
        columns = []
        for place in self._grid.places:
            speeds = speed_rad_s[begin : begin + len(place)]
            # Trapezoids over the samples, from rest at sample 0.
            known = np.interp(number, np.append(0, place), np.append(0.0, speeds))
            columns.append(self._grid.period_s * np.append(0.0, np.cumsum(0.5 * (known[1:] + known[:-1]))))
            begin += len(place)
        return np.stack(columns, axis=1)

"""Voltage -> current and speed of a motor on a bench in PyBullet: the robot is lifted, and its right wheel is driven.

PyBullet simulates the inertia of the wheel, so it is subtracted from the motor's inertia, which on a bench includes
everything that turns.
"""

from dataclasses import replace

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.engine.base import EngineStage, less
from diagnosis.measured.case_files.nominal import NominalStep
from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.predictors.base import Observed
from diagnosis.predictors.grid import Grid
from diagnosis.predictors.motor.steady import MotorSteady
from diagnosis.predictors.motor.step import MotorStep
from diagnosis.predictors.rows import joined, session_time_s
from sensors.wheels.instruments import read_current_A, read_settled_speed_rad_s, read_speed_rad_s
from symolo.core.arrays import Array

SETTLING = 12.0
"""Number of time constants after which a motor is in steady state, to 6e-6 of its speed."""
MAX_DURATION_S = 5.0


class MotorOnBench(EngineStage):
    """Held-out rows of a bench in PyBullet; the other rows are not simulated."""

    name = "bench"

    def __init__(self, measurement: Measurement, nominal: RobotConfig) -> None:
        self._measurement = measurement
        self.observed: tuple[Observed, ...]
        if measurement.kind is CaseKind.MOTOR_STEP:
            self.observed = MotorStep(measurement, nominal).observed
        else:
            stage = MotorSteady(measurement, nominal)
            # Near the voltage at which the motor starts, the engine has no input for what was seen.
            self.observed = tuple(replace(o, usable=o.usable & stage.is_far) for o in stage.observed)

    def _means(self, robot: RobotConfig) -> tuple[Array, Array]:
        is_step = self._measurement.kind is CaseKind.MOTOR_STEP
        return self._step_responses(robot) if is_step else self._settled(robot)

    def _settled(self, robot: RobotConfig) -> tuple[Array, Array]:
        """Return current [A] and speed [rad/s] in steady state, (n,) each."""
        trials = self._measurement.trials
        voltage_V = joined(trial["u_cmd_V"].values for trial in trials)
        heldout = joined(trial.holdout for trial in trials) & np.isfinite(voltage_V)
        current, speed = (np.full(len(voltage_V), np.nan) for _ in range(2))
        duration_s = min(SETTLING * _time_constant_s(robot), MAX_DURATION_S)
        for volts in np.unique(voltage_V[heldout]).tolist():
            amperes, rad_s = _turned(robot, np.array([volts]), duration_s)
            rows = heldout & (voltage_V == volts)
            current[rows], speed[rows] = amperes[-1], rad_s[-1]
        since_on_s = session_time_s(self._measurement)
        read_speed = read_settled_speed_rad_s(robot.effects, speed, since_on_s)
        return read_current_A(robot.effects, current, since_on_s), read_speed

    def _step_responses(self, robot: RobotConfig) -> tuple[Array, Array]:
        """Return current [A] and speed [rad/s] against time, (n,) each."""
        measurement = self._measurement
        rate_hz = measurement.nominal.sample_rate_Hz if isinstance(measurement.nominal, NominalStep) else None
        grid = Grid.from_measurement(measurement, rate_hz)
        voltage_V = grid.zero_order_hold(measurement.trials, "u_cmd_V")
        current, speed = (np.full(voltage_V.shape, np.nan) for _ in range(2))
        for k, trial in enumerate(measurement.trials):
            if trial.holdout.any():
                current[:, k], speed[:, k] = _turned(robot, voltage_V[1:, k], grid.period_s)
        t_s = grid.period_s * np.arange(len(voltage_V))
        known = np.isfinite(speed[0])
        since_on_s = t_s[:, None] + grid.begins_s
        speed[:, known] = read_speed_rad_s(robot.effects, t_s, speed[:, known], since_on_s[:, known])
        return grid.of_rows(read_current_A(robot.effects, current, since_on_s)), grid.of_rows(speed)


def _turned(robot: RobotConfig, voltage_V: Array, row_s: float) -> tuple[Array, Array]:
    """Return current and speed of the right wheel at the ends of rows, (T + 1,) each; the left wheel is at rest."""
    from physics.bullet.open_loop import open_loop  # noqa: PLC0415 - loads pybullet, which only this needs

    motor, drive = robot.motor, robot.drive
    spin = 0.5 * drive.wheel_mass_kg * (0.5 * drive.wheel_diameter_m) ** 2
    bare = robot.with_section("motor", {"rotor_inertia_kg_m2": less(motor.rotor_inertia_kg_m2, spin)})
    both = np.stack([voltage_V, np.zeros_like(voltage_V)], axis=1)
    states = open_loop(bare, both, row_s, lifted=True)
    return states.current_A[:, 0], states.wheel_speed_rad_s[:, 0]


def _time_constant_s(robot: RobotConfig) -> float:
    """Return R J / (K^2 + R B)."""
    motor = robot.motor
    resistance, constant = motor.winding_resistance_ohm, motor.torque_constant_N_m_A
    damping = constant**2 + resistance * motor.viscous_friction_N_m_s_rad
    return resistance * motor.rotor_inertia_kg_m2 / damping

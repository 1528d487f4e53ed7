"""Responses of rotor and gearbox to steps of voltage from rest, compared with the time constant of Eq. 20."""

from math import log

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.validation.experiment import ExperimentResult, ValidationCheck
from diagnosis.validation.measures import first_reached
from diagnosis.validation.panels import COLORS, DASHES, Curve, Panel
from physics.drivetrain.motor import MotorModel
from physics.drivetrain.motor_bench import steady_states, step_responses
from physics.drivetrain.wheel_loop import voltage_limit_V
from physics.robot.model import RobotModel

SHARES = (0.25, 0.5, 0.75, 1.0)
"""Steps as shares of the highest voltage that the robot's bridge applies."""
ROWS_PER_TIME_CONSTANT = 50
TIME_CONSTANTS = 8
TOLERANCE = 0.01
"""Largest relative difference from a closed form."""


def time_constant_s(motor: MotorModel) -> float:
    """Return the time constant of Eq. 20 with the inductance neglected: R J / (K^2 + R B)."""
    resistance, constant = motor.resistance_ohm, motor.torque_constant_N_m_A
    return resistance * motor.inertia_kg_m2 / (constant**2 + resistance * motor.viscous_N_m_s_rad)


def is_ideal(robot: RobotConfig) -> bool:
    """Return whether the robot has no effects, so that the closed forms of Eq. 15-21 hold for its motor."""
    return not list(robot.effects)


def steps(robot: RobotConfig, _seed: int) -> ExperimentResult:
    """Return responses of the right motor of the robot without load, with all effects of the robot."""
    model = RobotModel.from_config(robot)
    constant_s = time_constant_s(model.motors.right)
    row_s = constant_s / ROWS_PER_TIME_CONSTANT
    rows = TIME_CONSTANTS * ROWS_PER_TIME_CONSTANT + round(model.input_delay_s / row_s)
    voltage = voltage_limit_V(robot.power) * np.array(SHARES)
    current, speed = step_responses(model, np.tile(voltage, (rows, 1)), row_s)
    _, settled = steady_states(model, voltage, np.zeros_like(voltage))
    time = row_s * np.arange(1, rows + 1)
    late_s, rise_s = constant_s + model.input_delay_s, log(9.0) * constant_s
    tables: dict = {
        "closed_form": {
            "time_constant_s": constant_s,
            "input_delay_s": model.input_delay_s,
            "rise_10_90_percent_s": rise_s,
        }
    }
    checks, speeds, currents = [], [], []
    for k, step_V in enumerate(voltage.tolist()):
        levels = settled[k] * np.array([0.1, 1.0 - np.exp(-1.0), 0.9])
        # The wheel is at rest at time 0, one row before the first; a wheel that is stuck reaches no level.
        from_rest = np.append(0.0, time), np.append(0.0, speed[:, k])
        start, reached, end = (first_reached(*from_rest, level) for level in levels.tolist())
        name = f"step to {step_V:g} V"
        tables[name] = {
            "voltage_V": step_V,
            "time_s": time,
            "current_A": current[:, k],
            "speed_rad_s": speed[:, k],
            "settled_rad_s": settled[k],
            "time_to_63_percent_s": reached,
            "rise_10_90_percent_s": end - start,
        }
        for what, value, expected in (("63 % after", reached, late_s), ("10-90 % in", end - start, rise_s)):
            tolerance = 1e3 * TOLERANCE * expected if is_ideal(robot) and settled[k] != 0.0 else None
            checks.append(ValidationCheck(f"{name}, {what}", 1e3 * value, 1e3 * expected, tolerance, "Eq. 20", "ms"))
        speeds.append(Curve(1e3 * time, speed[:, k], f"{step_V:g} V", COLORS[k], DASHES[k]))
        currents.append(Curve(1e3 * time, 1e3 * current[:, k], f"{step_V:g} V", COLORS[k], DASHES[k]))
        speeds.append(Curve([1e3 * reached], [0.632 * settled[k]], color=COLORS[k], style="o"))
    panels = (
        Panel("Step from rest, points at 63 %", "time [ms]", "speed [rad/s]", speeds, x_lines=[1e3 * late_s]),
        Panel("Step from rest, inductance neglected", "time [ms]", "current [mA]", currents),
    )
    return ExperimentResult(tables, checks, panels)

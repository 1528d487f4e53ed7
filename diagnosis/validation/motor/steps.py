"""Steps of voltage from rest on rotor and gearbox: speed and current against time, beside Eq. 20's time constant."""

from dataclasses import dataclass
from math import log

import numpy as np

from diagnosis.validation.crossing import first_reached
from physics.drivetrain.motor import MotorModel
from physics.drivetrain.motor_bench import steady_states, step_responses
from physics.drivetrain.wheel_loop import voltage_limit_V
from physics.robot.model import RobotModel
from symolo.core.arrays import Array

SHARES = (0.25, 0.5, 0.75, 1.0)
"""Of the highest voltage that the robot's bridge applies."""
ROWS_PER_TIME_CONSTANT = 50
TIME_CONSTANTS = 8


@dataclass(frozen=True)
class StepResponse:
    """One step at time 0; rows at equal times, the first one row after the step."""

    voltage_V: float
    time_s: tuple[float, ...]
    current_A: tuple[float, ...]
    speed_rad_s: tuple[float, ...]
    settled_rad_s: float
    """By the balance of torques, not by waiting."""
    time_to_63_percent_s: float | None
    """From the step on, to 1 - 1/e of the settled speed; None where the wheel is stuck or never comes so far."""
    rise_10_90_percent_s: float | None


@dataclass(frozen=True)
class StepBench:
    time_constant_s: float
    """R J / (K^2 + R B), of the motor without effects of friction, bridge and supply."""
    input_delay_s: float
    """By which the time to 63 % is longer than the time constant."""
    rise_10_90_percent_s: float
    """Closed form: ln 9 time constants."""
    responses: tuple[StepResponse, ...]


def time_constant_s(motor: MotorModel) -> float:
    """Eq. 20 with the inductance neglected: R J / (K^2 + R B)."""
    resistance, constant = motor.resistance_ohm, motor.torque_constant_N_m_A
    return resistance * motor.inertia_kg_m2 / (constant**2 + resistance * motor.viscous_N_m_s_rad)


def step_bench(model: RobotModel) -> StepBench:
    """Responses of the robot's right motor, off load, with all of the robot's effects."""
    constant_s = time_constant_s(model.motors.right)
    row_s = constant_s / ROWS_PER_TIME_CONSTANT
    rows = TIME_CONSTANTS * ROWS_PER_TIME_CONSTANT + round(model.input_delay_s / row_s)
    voltage = voltage_limit_V(model.config.power) * np.array(SHARES)
    current, speed = step_responses(model, np.tile(voltage, (rows, 1)), row_s)
    _, settled = steady_states(model, voltage, np.zeros_like(voltage))
    time = row_s * np.arange(1, rows + 1)
    return StepBench(
        time_constant_s=constant_s,
        input_delay_s=model.input_delay_s,
        rise_10_90_percent_s=log(9.0) * constant_s,
        responses=tuple(
            _response(float(voltage[k]), time, current[:, k], speed[:, k], float(settled[k]))
            for k in range(len(voltage))
        ),
    )


def _response(voltage_V: float, time: Array, current: Array, speed: Array, settled: float) -> StepResponse:
    first, last = _first_time(time, speed, 0.1 * settled), _first_time(time, speed, 0.9 * settled)
    return StepResponse(
        voltage_V=voltage_V,
        time_s=tuple(time.tolist()),
        current_A=tuple(current.tolist()),
        speed_rad_s=tuple(speed.tolist()),
        settled_rad_s=settled,
        time_to_63_percent_s=_first_time(time, speed, (1.0 - np.exp(-1.0)) * settled),
        rise_10_90_percent_s=None if first is None or last is None else last - first,
    )


def _first_time(time: Array, speed: Array, level: float) -> float | None:
    """When the speed, which is 0 at time 0, first reaches a level; None for a level of 0 or out of reach."""
    if level == 0.0 or speed.max() < level:
        return None
    return first_reached(np.append(0.0, time), np.append(0.0, speed), level)

"""Stick-slip: the voltages at which a wheel breaks away and comes to rest, and whether it is at rest in between."""

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from diagnosis.validation.experiment import ExperimentResult, ValidationCheck
from diagnosis.validation.motor.steps import is_ideal, time_constant_s
from diagnosis.validation.panels import Curve, Panel
from physics.drivetrain.motor_bench import step_responses
from physics.robot.model import RobotModel
from symolo.core.arrays import Array
from symolo.pages.plotting import ORANGE, VERMILION

ROW_S = 5e-4
LEG_S = 2.0
"""Duration of the ramp from 0 V to its highest voltage."""
BREAKAWAYS = 2.5
"""Highest voltage of the ramp, in breakaway voltages."""
MIN_TOP_V = 0.2
"""Highest voltage of the ramp for a motor without dry friction."""
HELD_SHARES = (-0.999, -0.5, 0.0, 0.5, 0.9, 0.999)
"""Shares of the breakaway voltage at which a wheel must not move."""
HELD_S = 1.0
TABLE_ROWS = 801


def stiction(robot: RobotConfig, _seed: int) -> ExperimentResult:
    """Return the responses of the right motor with its effects to a slow ramp 0, +top, -top, 0 and to held voltages."""
    model = RobotModel.from_config(robot)
    motor = model.motors.right
    breakaway_V = motor.resistance_ohm * motor.coulomb_N_m / motor.torque_constant_N_m_A
    held_V = breakaway_V * np.array(HELD_SHARES)
    _, held = step_responses(model, np.tile(held_V, (round(HELD_S / ROW_S), 1)), ROW_S)
    top_V = max(BREAKAWAYS * breakaway_V, MIN_TOP_V)
    rows = round(LEG_S / ROW_S)
    corners = np.array([0.0, top_V, -top_V, 0.0])
    voltage = np.interp(np.arange(1, 4 * rows + 1), [0, rows, 3 * rows, 4 * rows], corners)
    _, speed = step_responses(model, voltage[:, None], ROW_S)
    speed = speed[:, 0]
    breaks_V = _first_voltage(voltage, speed != 0.0)
    stops_V = _first_voltage(voltage[rows:], speed[rows:] <= 0.0) if speed[rows - 1] > 0.0 else np.nan
    # The speed follows the falling voltage a time constant late.
    stops_closed_form_V = breakaway_V - top_V / LEG_S * time_constant_s(motor)
    resolution_V = top_V / rows
    starts, reversals = starts_and_reversals(speed)
    known = 2.0 * resolution_V if is_ideal(robot) else None
    checks = (
        ValidationCheck("breaks away at", breaks_V, breakaway_V, known, "R Tq / K", "V"),
        ValidationCheck("comes to rest at", stops_V, stops_closed_form_V, known, "R Tq / K, a time constant late", "V"),
        ValidationCheck("fastest wheel below breakaway", float(np.abs(held).max()), 0.0, 0.0, "dry friction", "rad/s"),
        ValidationCheck("starts from rest", starts, 2, 0, "one in each direction; more of them are chatter"),
        ValidationCheck("reversals", reversals, 1, 0, "one, where the voltage passes through zero"),
    )
    shown = np.unique(np.linspace(0, len(voltage) - 1, TABLE_ROWS).round().astype(int))
    ramp = {
        "voltage_V": voltage[shown],
        "speed_rad_s": speed[shown],
        "ramp_V_s": top_V / LEG_S,
        "resolution_V": resolution_V,
    }
    tables = {"ramp": ramp, "held_below_breakaway": {"voltage_V": held_V}}
    curves = (
        Curve(1e3 * voltage[shown], speed[shown], "slow ramp up, down, back to 0"),
        Curve([1e3 * breaks_V], [0.0], "breaks away", VERMILION, "^", size=8),
        Curve([1e3 * stops_V], [0.0], "comes to rest", ORANGE, "v", size=8),
    )
    fastest = float(np.abs(speed).max())
    return ExperimentResult(
        tables, checks, _panels(curves, breakaway_V, stops_closed_form_V, max_speed_rad_s=fastest, step_V=resolution_V)
    )


def _panels(
    curves: tuple[Curve, ...], breakaway_V: float, stops_V: float, *, max_speed_rad_s: float, step_V: float
) -> tuple[Panel, Panel]:
    """Return the whole ramp, and its part around the voltages at which the wheel breaks away and comes to rest."""
    axes = "voltage [mV]", "speed [rad/s]"
    near_mV = 1e3 * max(abs(breakaway_V - stops_V), step_V)
    return (
        Panel("Stiction, dashed: R Tq / K", *axes, curves, x_lines=(-1e3 * breakaway_V, 1e3 * breakaway_V)),
        Panel(
            "Stiction, close-up",
            *axes,
            curves,
            x_lines=(1e3 * breakaway_V, 1e3 * stops_V),
            x_range=(1e3 * stops_V - near_mV, 1e3 * breakaway_V + near_mV),
            y_range=(-0.03 * max_speed_rad_s, 0.08 * max_speed_rad_s),
        ),
    )


def starts_and_reversals(speed_rad_s: Array) -> tuple[int, int]:
    """Return how often a wheel, at rest before the first row, left rest, and how often its direction changed; (N,)."""
    moves = np.concatenate([[False], speed_rad_s != 0.0])
    direction = np.sign(speed_rad_s[speed_rad_s != 0.0])
    return int(np.sum(moves[1:] & ~moves[:-1])), int(np.sum(direction[1:] != direction[:-1]))


def _first_voltage(voltage: Array, where: NDArray[np.bool_]) -> float:
    return float(voltage[np.argmax(where)]) if where.any() else np.nan

"""Stick-slip at the bench: where a wheel breaks away, where it comes to rest, and whether it is still in between."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.validation.motor.steps import time_constant_s
from physics.drivetrain.motor_bench import step_responses
from physics.robot.model import RobotModel
from symolo.core.arrays import Array

ROW_S = 5e-4
LEG_S = 2.0
"""From 0 V to the highest voltage of the ramp."""
BREAKAWAYS = 2.5
"""Highest voltage of the ramp, in breakaway voltages."""
LOWEST_TOP_V = 0.2
"""Of a motor without dry friction."""
HELD_SHARES = (-0.999, -0.5, 0.0, 0.5, 0.9, 0.999)
"""Of the breakaway voltage, at which a wheel must not move."""
HELD_S = 1.0
KEPT_ROWS = 801


@dataclass(frozen=True)
class StictionBench:
    """A slow ramp 0, +top, -top, 0 from rest; without effects, static friction is the friction of a moving wheel."""

    breakaway_V: float | None
    """Where the wheel first moves; None where it never does."""
    breakaway_closed_form_V: float
    """R Tq / K, of the motor without effects of friction, bridge and supply."""
    stops_V: float | None
    """Where it comes to rest as the voltage falls; below 0 V where it is still turning there."""
    stops_closed_form_V: float
    """The breakaway voltage less what the ramp changes in a time constant, for the speed lags behind."""
    ramp_V_s: float
    resolution_V: float
    """What the ramp changes in a row, hence how well both voltages are known."""
    held_below_breakaway_V: tuple[float, ...]
    """Voltages held from rest."""
    fastest_held_rad_s: float
    """Highest speed reached at any of them: exactly 0.0 where dry friction holds."""
    starts: int
    """How often the wheel left rest: once in each direction, more where it chatters."""
    reversals: int
    """How often the direction changed: once, while the voltage passed through zero."""
    voltage_V: tuple[float, ...]
    """Of the ramp, rows kept for the picture."""
    speed_rad_s: tuple[float, ...]


def stiction_bench(model: RobotModel) -> StictionBench:
    """Ramp and held voltages on the robot's right motor, off load, with all of the robot's effects."""
    motor = model.motors.right
    breakaway_V = motor.resistance_ohm * motor.coulomb_N_m / motor.torque_constant_N_m_A
    held_V = breakaway_V * np.array(HELD_SHARES)
    _, held = step_responses(model, np.tile(held_V, (round(HELD_S / ROW_S), 1)), ROW_S)
    top_V = max(BREAKAWAYS * breakaway_V, LOWEST_TOP_V)
    rows = round(LEG_S / ROW_S)
    corners = np.array([0.0, top_V, -top_V, 0.0])
    voltage = np.interp(np.arange(1, 4 * rows + 1), [0, rows, 3 * rows, 4 * rows], corners)
    _, speed = step_responses(model, voltage[:, None], ROW_S)
    speed = speed[:, 0]
    kept = np.unique(np.linspace(0, len(voltage) - 1, KEPT_ROWS).round().astype(int))
    starts, reversals = starts_and_reversals(speed)
    return StictionBench(
        breakaway_V=_voltage_of_first(voltage, speed != 0.0),
        breakaway_closed_form_V=breakaway_V,
        stops_V=_voltage_of_first(voltage[rows:], speed[rows:] <= 0.0) if speed[rows - 1] > 0.0 else None,
        stops_closed_form_V=breakaway_V - top_V / LEG_S * time_constant_s(motor),
        ramp_V_s=top_V / LEG_S,
        resolution_V=top_V / rows,
        held_below_breakaway_V=tuple(held_V.tolist()),
        fastest_held_rad_s=float(np.abs(held).max()),
        starts=starts,
        reversals=reversals,
        voltage_V=tuple(voltage[kept].tolist()),
        speed_rad_s=tuple(speed[kept].tolist()),
    )


def starts_and_reversals(speed_rad_s: Array) -> tuple[int, int]:
    """How often a wheel, at rest before the first row, left rest, and how often its direction changed; (N,)."""
    moves = np.concatenate([[False], speed_rad_s != 0.0])
    direction = np.sign(speed_rad_s[speed_rad_s != 0.0])
    return int(np.sum(moves[1:] & ~moves[:-1])), int(np.sum(direction[1:] != direction[:-1]))


def _voltage_of_first(voltage: Array, found: NDArray[np.bool_]) -> float | None:
    return float(voltage[np.argmax(found)]) if found.any() else None

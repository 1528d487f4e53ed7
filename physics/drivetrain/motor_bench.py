"""One motor on a bench with the effects of its robot: steady states and step responses, without noise.

`sensors.instruments` turns current and speed into the readings of the bench. The numbers of many robots may be stacked,
(M, 1, 1) each (`physics.robot.stack`); results are then those of all of them.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from physics.drivetrain.driveline import Driveline
from physics.drivetrain.held_rows import held_rows
from physics.drivetrain.shaft import shaft_of
from physics.drivetrain.two_mass import TwoMass
from physics.robot.model import RobotModel
from symolo.core.arrays import Array
from symolo.core.finite import require_finite

SETTLED = 1e-11
"""Accuracy of a steady speed, relative to the highest speed."""
MAX_STEPS = 200


def steady_states(
    model: RobotModel, voltage_V: Array, time_s: Array, supply_V: Array | None = None
) -> tuple[Array, Array]:
    """Return current [A] and speed [rad/s], (N,) or (M, N) each, reached from rest at constant voltages.

    Args:
        model: The robot, or M of them, whose right motor is on the bench.
        voltage_V: (N,), constant voltages.
        time_s: (N,), time since the motor was first switched on.
        supply_V: (N,), voltage of the supply; that of the robot by default.

    Raises:
        ValueError: A voltage is not a finite number.
    """
    require_finite(voltage_V, "voltage_V", ("trial",))
    driveline = Driveline.of_bench(model)
    if supply_V is not None:
        driveline.full_supply_V = supply_V[:, None]
    time = time_s[:, None]
    command = voltage_V[:, None]
    _, voltage = driveline.voltage_V(command, command, time, np.inf)
    no_load_V = driveline.supply_V(time)
    sign = np.sign(voltage)

    def surplus_N_m(speed: Array) -> Array:
        drive = driveline.torque_constant_N_m_A * driveline.current_A(voltage, speed, no_load_V)
        friction = driveline.friction_N_m(drive, speed, time)
        return sign * (drive - driveline.viscous_N_m_s_rad * speed) - friction

    def surplus_forward_N_m(size: Array) -> Array:
        return surplus_N_m(sign * size)

    rest = np.zeros_like(voltage)
    at_rest = surplus_N_m(rest)
    top = np.abs(voltage) / driveline.torque_constant_N_m_A
    if driveline.may_coast:
        top = np.where(surplus_forward_N_m(top) > 0.0, no_load_V / driveline.torque_constant_N_m_A, top)
    moves = at_rest > 0.0
    speed = np.where(moves, sign * _root(surplus_forward_N_m, at_rest, top, moves), 0.0)
    return driveline.current_A(voltage, speed, no_load_V)[..., 0], speed[..., 0]


def _root(function: Callable[[Array], Array], at_0: Array, top: Array, wanted: NDArray[np.bool_]) -> Array:
    """Return the zero of a function that falls from `at_0` at 0 to below 0 at `top`, by the Illinois method.

    One step finds the zero of a straight line; kinks and curves take about ten. Every third step halves the bracket,
    which bounds the number of steps. Elements that are not `wanted` are not iterated to the end.
    """
    low: Array = np.zeros_like(at_0)
    high, at_low, at_high = low + top, at_0, function(top)
    root, was_above = low, wanted
    for step in range(MAX_STEPS):
        spread = at_low - at_high
        share = np.clip(at_low / np.where(spread > 0.0, spread, 1.0), 0.0, 1.0)
        halves = step % 3 == 2
        before, root = root, low + (high - low) * (np.full_like(share, 0.5) if halves else share)
        value = function(root)
        if not halves and np.all((np.abs(root - before) <= SETTLED * top) | (value == 0.0) | ~wanted):
            break
        above = value > 0.0
        # The value at an end that stays twice is halved, so that the end does not stay for ever.
        again = np.where(above == was_above, 0.5, 1.0)
        at_low, at_high = np.where(above, value, again * at_low), np.where(above, again * at_high, value)
        low, high, was_above = np.where(above, root, low), np.where(above, high, root), above
    return root


def step_responses(
    model: RobotModel, voltage_V: Array, row_s: float, begin_s: Array | None = None
) -> tuple[Array, Array]:
    """Return current [A] and speed [rad/s] on the motor side of the gearbox at the end of each row, from rest.

    Args:
        model: The robot, or M of them, whose right motor is on the bench.
        voltage_V: (T, N), each constant for the row that ends at its sample.
        row_s: Duration of a row.
        begin_s: (N,), time of each trial's start since the motor was first switched on; 0 by default.

    Returns:
        (T, N) or (T, M, N) each. The current is that at the mean voltage of the last half millisecond of the row, in
        which a delayed command may take effect.

    Raises:
        ValueError: A voltage is not a finite number.
    """
    require_finite(voltage_V, "voltage_V", ("row", "trial"))
    driveline = Driveline.of_bench(model)
    shaft = shaft_of(model, driveline)
    begin = np.zeros((voltage_V.shape[1], 1)) if begin_s is None else begin_s[:, None]
    rest = np.zeros((voltage_V.shape[1], 1))
    state = TwoMass(rest, rest, rest)
    voltages, supplies, speeds = [], [], []
    for row in held_rows(driveline, voltage_V[..., None], row_s, model.input_delay_s, begin):
        for part in row.parts:
            state = shaft.moved(part, state)
        voltages.append(row.last_V)
        supplies.append(np.broadcast_to(row.supply_V, np.broadcast_shapes(np.shape(row.supply_V), rest.shape)))
        speeds.append(state.motor_rad_s)
    voltage, supply, speed = (np.stack(np.broadcast_arrays(*rows)) for rows in (voltages, supplies, speeds))
    voltage, supply = (rows[:, None] if rows.ndim < speed.ndim else rows for rows in (voltage, supply))
    return driveline.current_A(voltage, speed, supply)[..., 0], speed[..., 0]

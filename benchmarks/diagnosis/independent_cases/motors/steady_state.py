"""Steady state of a motor that starts from rest at a held voltage."""

import numpy as np

from benchmarks.diagnosis.independent_cases.motors.motor_law import Lanes, current, dry_friction
from benchmarks.diagnosis.independent_cases.recipes import Array

GRID = 96
HALVINGS = 40


def solve(lanes: Lanes, u: Array) -> tuple[Array, Array]:
    """Return currents (A) and speeds (rad/s), each (lanes, rows), at the voltages u (rows,) in V.

    The motor is stuck while the drive torque does not exceed the breakaway torque. Otherwise it climbs from rest to
    the first speed at which the net torque vanishes, which a grid brackets and halving refines.
    """
    u = np.broadcast_to(u, (lanes.R.shape[0], u.shape[-1]))
    direction, v = np.sign(u), np.abs(u)

    def net_torque(speed: Array) -> Array:
        return lanes.K * current(lanes, v, speed) - lanes.B * speed - dry_friction(lanes, speed, direction)

    moving = net_torque(np.zeros_like(v)) > 0
    top = np.where(lanes.coast > 0, lanes.U, v) / lanes.K
    low, high = np.zeros_like(v), top.copy()
    bracketed = ~moving
    for i in range(1, GRID + 1):
        speed = top * (i / GRID) ** 2
        ends = ~bracketed & (net_torque(speed) <= 0)
        high = np.where(ends, speed, high)
        bracketed |= ends
        low = np.where(bracketed, low, speed)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        up = net_torque(middle) > 0
        low, high = np.where(up, middle, low), np.where(up, high, middle)
    speed = np.where(moving, 0.5 * (low + high), 0.0)
    return direction * current(lanes, v, speed), direction * speed

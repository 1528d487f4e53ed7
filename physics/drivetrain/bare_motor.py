"""Bare motors in successive rows: one exact step for each period at constant voltage.

`rigid_wheels` has the same for motors with any effects. Here, all that the speeds do not change is computed once.
"""

from collections.abc import Iterator
from itertools import repeat

import numpy as np

from physics.drivetrain.driveline import Driveline
from physics.drivetrain.held_rows import HeldVoltages
from physics.drivetrain.motor_arrays import HeldDrive, covered_share
from symolo.core.arrays import Array, stacked_rows

_Period = tuple[HeldDrive, Array, Array]
"""A period at constant voltage: the motors in it, its duration [s], and its `covered_share`."""


def bare_speeds(driveline: Driveline, held: HeldVoltages, speed_rad_s: Array) -> Array:
    """Return the speeds at the end of each row, (T, N, wheels) or (T, M, N, wheels).

    Args:
        driveline: Motors without effects on torque and friction.
        held: Their voltages in T rows.
        speed_rad_s: (N, wheels), speeds before the first row.
    """
    speeds = []
    for periods in _periods_of_rows(driveline, held, speed_rad_s.shape):
        for drive, duration_s, covered in periods:
            speed_rad_s = drive.speed_after(speed_rad_s, duration_s, covered)
        speeds.append(speed_rad_s)
    return stacked_rows(speeds, speed_rad_s.shape)


def bare_turns(driveline: Driveline, held: HeldVoltages, speed_rad_s: Array) -> Array:
    """Return the angles [rad] that the motors turn in each row, of the same shape; arguments are the same as well."""
    turns = []
    for periods in _periods_of_rows(driveline, held, speed_rad_s.shape):
        turned: float | Array = 0.0
        for drive, duration_s, covered in periods:
            speed_rad_s, further = drive.step(speed_rad_s, duration_s, covered)
            turned = turned + further
        turns.append(turned)
    return stacked_rows(turns, speed_rad_s.shape)


def _periods_of_rows(driveline: Driveline, held: HeldVoltages, shape: tuple[int, ...]) -> Iterator[tuple[_Period, ...]]:
    """Yield the periods of each row: one, or two if a delayed command takes effect within the row."""
    numbers = (driveline.damping_N_m_s_rad, driveline.coulomb_N_m, driveline.inertia_kg_m2)
    shape = np.broadcast_shapes(shape, held.mean_V.shape[1:], *(number.shape for number in numbers))
    # Small arrays of one shape are combined in half the time of those that broadcast to each other.
    damping, friction, inertia = (np.full(shape, each) for each in numbers)
    durations = (held.durations.whole_s, held.durations.before_s, held.durations.after_s)

    def lasting(duration_s: float | Array) -> tuple[Array, Array]:
        duration_s = np.full(shape, duration_s)
        return duration_s, covered_share(duration_s, inertia / damping)

    if held.durations.differ:
        lasts = (tuple(map(lasting, row_durations)) for row_durations in zip(*map(np.asarray, durations), strict=True))
    else:
        lasts = repeat(tuple(map(lasting, durations)))
    torques, old, new = (
        [driveline.stall_torque_N_m(voltage_V) for voltage_V in rows_V]
        for rows_V in (held.mean_V, held.old_V, held.new_V)
    )
    for torque, place, (whole, before, after) in zip(torques, held.cut.tolist(), lasts, strict=False):
        periods = ((torque, whole),) if place < 0 else ((old[place], before), (new[place], after))
        yield tuple((HeldDrive(t, damping, friction, inertia), *each) for t, each in periods)

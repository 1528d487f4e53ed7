"""The error of logged headings, which is a function of the headings without it."""

from collections.abc import Callable

import numpy as np

from physics.robot.model import applied
from symolo.core.arrays import Array

PASSES = 6
"""Passes in which two quantities that depend on each other are computed, such as a heading and its error."""


def heading_error_rad(functions: tuple[Callable[..., Array], ...], logged_rad: Array, time_s: Array) -> Array:
    """Return the error of logged headings (n,) or (M, n), by the functions of the effects on it."""
    error_rad = np.zeros_like(logged_rad)
    for _ in range(PASSES):
        error_rad = applied(functions, np.zeros_like(logged_rad), logged_rad - error_rad, time_s)
    return error_rad


def error_along_path(
    functions: tuple[Callable[..., Array], ...], turned_rad: Array, first_rad: Array, first_s: Array, time_s: Array
) -> Array:
    """Return the error of headings (n,) or (M, n) along a path of which only the first heading was logged.

    Args:
        functions: Those of the effects on the heading.
        turned_rad: Angle by which the robot has turned since the first row.
        first_rad: Logged heading in the first row.
        first_s: Time of the first row.
        time_s: (n,), times.
    """
    yaw_rad = turned_rad + first_rad - heading_error_rad(functions, first_rad, first_s)
    return applied(functions, np.zeros_like(yaw_rad), yaw_rad, time_s)


def turned_by(pose: Array, turn_rad: Array) -> Array:
    """Return poses (n, 3) or (M, n, 3) with other yaws in the same places."""
    x_m, y_m, yaw_rad = np.moveaxis(pose, -1, 0)
    return np.stack(np.broadcast_arrays(x_m, y_m, yaw_rad + turn_rad), axis=-1)

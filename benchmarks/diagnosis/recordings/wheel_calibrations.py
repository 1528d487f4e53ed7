"""Calibrations of two driven wheels as they are usual, to compare the diagnosis with; they share no code with it.

A run is an array (n, 6): t [s], x [m], y [m], heading [rad], counts of the right wheel in this row, of the left wheel.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi, sin

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Wheels:
    left_diameter_m: float
    right_diameter_m: float
    track_m: float


def odometry(run: Array, wheels: Wheels, counts_per_turn: float) -> Array:
    """Return poses (n, 3) from the first one and the counts, by the mid-point rule."""
    right_m = pi * wheels.right_diameter_m / counts_per_turn * run[:, 4]
    left_m = pi * wheels.left_diameter_m / counts_per_turn * run[:, 5]
    forward_m, turn_rad = (right_m + left_m) / 2.0, (right_m - left_m) / wheels.track_m
    forward_m[0] = turn_rad[0] = 0.0
    yaw = run[0, 3] + np.cumsum(turn_rad)
    middle = yaw - turn_rad / 2.0
    x, y = run[0, 1] + np.cumsum(forward_m * np.cos(middle)), run[0, 2] + np.cumsum(forward_m * np.sin(middle))
    return np.stack([x, y, yaw], axis=1)


def by_whole_paths(runs: Sequence[Array], nominal: Wheels, counts_per_turn: float) -> Wheels:
    """Return both diameters and the track for which all poses of all runs are hit best, in the sense of least squares.

    The authors of the OptiOdom data fit whole paths too (Sousa et al., J. Intell. Robot. Syst. 105:39 (2022)). A radian
    counts as half the track, the distance of a wheel from the middle, without which turns on the spot would not count.
    """
    start = np.array([nominal.left_diameter_m, nominal.right_diameter_m, nominal.track_m])

    def missed(factors: Array) -> Array:
        wheels = Wheels(*(start * factors).tolist())
        return np.concatenate(
            [(lever * (odometry(run, wheels, counts_per_turn) - run[:, 1:4])).ravel() for run in runs]
        )

    lever = np.array([1.0, 1.0, nominal.track_m / 2.0])
    return Wheels(*(start * least_squares(missed, np.ones(3), x_scale=1e-3, diff_step=1e-5).x).tolist())


def umbmark(runs: Sequence[Array], side_m: float, driven: Wheels, counts_per_turn: float) -> Wheels:
    """Return the wheels by the closed form for squares that are driven in both directions.

    Track and ratio of the diameters follow from the centres of gravity of the errors at the end of the runs (Borenstein
    and Feng, IEEE Trans. Robotics and Automation 12 (1996) 869-880).

    Args:
        runs: Squares, of either sense.
        side_m: Side of the square.
        driven: Wheels that the controller assumed when it drove them.
        counts_per_turn: Encoder counts of a turn of a wheel.
    """
    missed: dict[bool, list[Array]] = {True: [], False: []}
    for run in runs:
        believed = odometry(run, driven, counts_per_turn)[-1]
        missed[bool(run[-1, 3] < run[0, 3])].append(run[-1, 1:3] - believed[:2])
    clockwise, counter = (np.mean(missed[sense], axis=0) for sense in (True, False))
    alpha = float((clockwise[0] + counter[0]) / (-4.0 * side_m))
    beta = float((clockwise[0] - counter[0]) / (-4.0 * side_m))
    track_m = driven.track_m * (pi / 2.0) / (pi / 2.0 - alpha)
    if beta == 0.0:
        return Wheels(driven.left_diameter_m, driven.right_diameter_m, track_m)
    bend_m = side_m / 2.0 / sin(beta / 2.0)
    ratio = (bend_m + driven.track_m / 2.0) / (bend_m - driven.track_m / 2.0)
    mean_m = (driven.left_diameter_m + driven.right_diameter_m) / 2.0
    return Wheels(2.0 / (ratio + 1.0) * mean_m, 2.0 / (1.0 / ratio + 1.0) * mean_m, track_m)


def with_turned_camera(runs: Sequence[Array], nominal: Wheels, counts_per_turn: float) -> tuple[Wheels, float]:
    """Return the wheels as `by_whole_paths`, and the angle of the tracked heading to that of the wheels [rad].

    The angle is the part of the remaining error that belongs to the camera's body and not to the robot.
    """
    start = np.array([nominal.left_diameter_m, nominal.right_diameter_m, nominal.track_m])

    def missed(numbers: Array) -> Array:
        wheels, off = Wheels(*(start * numbers[:3]).tolist()), 1e-2 * numbers[3]
        errors = []
        for run in runs:
            path = turned(odometry(run, wheels, counts_per_turn), off)
            errors.append((lever * (path - run[:, 1:4])).ravel())
        return np.concatenate(errors)

    lever = np.array([1.0, 1.0, nominal.track_m / 2.0])

    best = least_squares(missed, np.array([1.0, 1.0, 1.0, 0.0]), x_scale=np.array([1e-3] * 3 + [0.1]), diff_step=1e-5).x
    return Wheels(*(start * best[:3]).tolist()), float(1e-2 * best[3])


def turned(path: Array, angle_rad: float) -> Array:
    """Return a path (n, 3) whose places are turned about the first one by an angle; the headings stay."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    off = path[:, :2] - path[0, :2]
    places = path[0, :2] + np.stack([c * off[:, 0] - s * off[:, 1], s * off[:, 0] + c * off[:, 1]], axis=1)
    return np.concatenate([places, path[:, 2:]], axis=1)

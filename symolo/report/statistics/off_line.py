"""Distances of points on the floor from the middle of the line."""

import numpy as np

from symolo.arena.geometry import Line
from symolo.core.arrays import Array


def off_line_m(line: Line, points: Array) -> Array:
    """Return the distance of each floor point from the nearest point of the line's middle [m], (N,).

    Args:
        line: At least one piece.
        points: (N, 2), x [m], y [m] in W.
    """
    nearest = np.full(len(points), np.inf)
    for piece in line.pieces:
        s, offset = piece.local(points)
        ends = piece.at(np.array([0.0, piece.length_m]))
        to_ends = np.linalg.norm(points[:, None, :] - ends, axis=2).min(axis=1)
        beside = (s >= 0) & (s <= piece.length_m)
        nearest = np.minimum(nearest, np.where(beside, np.abs(offset), to_ends))
    return nearest


def ahead_of(pose: Array, x_m: float) -> Array:
    """Return the floor points (N, 2) in W that lie `x_m` ahead of the axle's middle.

    Args:
        pose: (N, 3), x [m], y [m], theta [rad] of the robot in W.
        x_m: Distance along x of the robot.
    """
    return pose[:, :2] + x_m * np.column_stack((np.cos(pose[:, 2]), np.sin(pose[:, 2])))

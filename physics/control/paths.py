"""Avoidance paths: evenly spaced points of a spline (paper section 4.3, Fig. 7)."""

from dataclasses import dataclass

import numpy as np

from configs.schema.controller import Avoidance, CurvePath
from physics.control.base import Side, sign_of
from symolo.core.arrays import Array

FINE = 8
"""Points of a spline that are evaluated per stored point."""


@dataclass(frozen=True)
class AvoidancePath:
    """A path in the frame of the robot where avoidance began: x forward, y left."""

    points: Array
    """(N, 2) [m], evenly spaced along the path."""
    spacing_m: float
    back_begins: int
    """Index of the first point of the return to the line; the number of points if there is none."""


def straight_path(config: Avoidance, side: Side) -> AvoidancePath:
    """Return the path out to a side, along the obstacle and back to the line or wall (Fig. 7a)."""
    x_out = config.out_length_m
    x_back = x_out + config.along_length_m
    x_end = x_back + config.back_length_m

    def y_at(x: Array) -> Array:
        # Flat at every knot, so that the path leaves, passes and meets the line in the direction of travel.
        t = np.minimum(x / x_out, np.clip((x_end - x) / config.back_length_m, 0.0, 1.0))
        return config.side_m * t * t * (3.0 - 2.0 * t)

    x_fine = np.linspace(0.0, x_end, FINE * config.points)
    travelled = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x_fine), np.diff(y_at(x_fine))))])
    even = np.linspace(0.0, travelled[-1], config.points)
    x = np.interp(even, travelled, x_fine)
    points = np.stack([x, sign_of(side) * y_at(x)], axis=1)
    points.flags.writeable = False
    return AvoidancePath(points, float(even[1]), int(np.searchsorted(x, x_back)))


def curve_path(config: CurvePath, count: int, bend: Side) -> AvoidancePath:
    """Return a path through control points (Fig. 7b, 7c); they describe a left bend and are mirrored for a right one.

    Args:
        config: The control points.
        count: Number of stored points.
        bend: The side to which the line bends.
    """
    from scipy.interpolate import CubicSpline  # noqa: PLC0415 - half a second, which most drives save

    knots = np.array(config.points)
    chord = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(knots, axis=0).T))])
    fine = CubicSpline(chord, knots)(np.linspace(0.0, chord[-1], FINE * count))
    travelled = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(fine, axis=0).T))])
    even = np.linspace(0.0, travelled[-1], count)
    drawn = np.stack([np.interp(even, travelled, fine[:, axis]) for axis in (0, 1)], axis=1)
    points = drawn * (1.0, sign_of(bend))
    points.flags.writeable = False
    return AvoidancePath(points, float(even[1]), count)

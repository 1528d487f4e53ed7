"""Agreement of headings with the path that they should follow: a robot rolls along its heading."""

import math

import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array

CHORD_M = 0.02
"""Length [m] of the chords whose direction is compared: some millimetres of noise turn it by some degrees only."""
MAX_UNJUDGED_CHORDS = 5
"""Number of chords up to which headings are not judged."""
EXPLAINED_RAD, UNEXPLAINED_RAD = math.radians(5), math.radians(10)
"""Median angles [rad] between chords and headings, up to which they fit the path and from which on they do not."""


def chords(place: Array, length_m: float = CHORD_M) -> np.ndarray:
    """Return the rows (M,) at the ends of chords; each is the first row that is `length_m` away from the one before.

    Args:
        place: (N, 2), x [m], y [m].
        length_m: Length of the chords.
    """
    rows, (last_x, last_y) = [0], place[0].tolist()
    for row, (x, y) in enumerate(place.tolist()):
        if math.hypot(x - last_x, y - last_y) >= length_m:
            rows.append(row)
            last_x, last_y = x, y
    return np.array(rows)


def angle_to_path(place: Array, yaw_rad: Array) -> float:
    """Return the median angle between chord and mean heading at its ends, the same forwards and backwards.

    Args:
        place: (M, 2), ends of chords.
        yaw_rad: (M,), headings there.
    """
    return float(np.median(np.abs(np.angle(_doubled(place, yaw_rad).sum(axis=1)))) / 2)


def turn_to_path(place: Array, yaw_rad: Array) -> float:
    """Return the angle (-pi to pi) that, added to all headings, turns them best along the path, mostly forwards.

    Args:
        place: (M, 2), ends of chords.
        yaw_rad: (M,), headings there.
    """
    turn = float(np.angle(_doubled(place, yaw_rad).sum())) / 2
    backwards = share_forwards(place, yaw_rad + turn) < 0.5
    return math.remainder(turn + math.pi * backwards, 2 * math.pi)


def _doubled(place: Array, yaw_rad: Array) -> NDArray[np.complex128]:
    """Return the angles between chords and the headings at both ends, (M - 1, 2), doubled, as unit vectors.

    Doubled angles make a heading and its opposite equal; their mean direction is that of the summed unit vectors.
    """
    steps = np.diff(place, axis=0)
    angle = np.arctan2(steps[:, 1], steps[:, 0])[:, None] - np.stack([yaw_rad[:-1], yaw_rad[1:]], axis=1)
    return np.exp(2j * angle)


def share_forwards(place: Array, yaw_rad: Array) -> float:
    """Return the share of chords (M - 1,) that lead forwards along the heading, 0 to 1."""
    steps = np.diff(place, axis=0)
    return float(np.mean(steps[:, 0] * np.cos(yaw_rad[1:]) + steps[:, 1] * np.sin(yaw_rad[1:]) > 0.0))


def headings_along(place: Array, length_m: float) -> Array | None:
    """Return the direction (N,) [rad] of the path at each place, unwrapped; None if nothing moves that far.

    Args:
        place: (N, 2), x [m], y [m].
        length_m: Distance over which the direction is measured, so that noise does not turn it.
    """
    ends = chords(place, length_m)
    if len(ends) < 2:
        return None
    steps = np.diff(place[ends], axis=0)
    yaw_rad = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    return np.interp(np.arange(len(place)), 0.5 * (ends[:-1] + ends[1:]), yaw_rad)

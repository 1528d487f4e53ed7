"""Agreement of headings with the path that they should follow: a robot rolls along its heading."""

import math

import numpy as np

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
    steps = np.diff(place, axis=0)
    # Doubled angles make a heading and its opposite equal; their mean direction is that of the summed unit vectors.
    twice = 2 * (np.arctan2(steps[:, 1], steps[:, 0])[:, None] - np.stack([yaw_rad[:-1], yaw_rad[1:]], axis=1))
    return float(np.median(np.abs(np.angle(np.exp(1j * twice).sum(axis=1)))) / 2)


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

"""Checks whether a trajectory from elsewhere is in milliseconds, metres and radians."""

import math
from collections.abc import Callable

import numpy as np

from blender_scenes.scene.run_scene import floor_bounds
from configs.schema.look import LookConfig
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.dataset.tables.rows import Rows

Where = Callable[[int], str]
"""Returns the place of a row for messages, such as `data.csv:7`."""

MAX_SPEED_M_S = 10.0
"""Largest speed that a small robot can have; most drive at 0.1 to 1 m/s, which seconds turn into 100 or more."""
CHORD_M = 0.02
"""Length [m] of the chords whose direction is compared: some millimetres of noise turn it by some degrees only."""
MAX_UNJUDGED_CHORDS = 5
"""Number of chords up to which the headings are not judged."""
EXPLAINED_RAD, UNEXPLAINED_RAD = math.radians(5), math.radians(10)
"""Median angles [rad] between chords and headings, up to which they fit the path and from which on they do not."""


def check_milliseconds(rows: Rows, at: Where) -> None:
    """Refuse a trajectory at a speed that a small robot cannot have; the median counts, so that a jump is no reason.

    Raises:
        InputError: The robot is too fast; the suspected unit is named.
    """
    path_m = np.hypot(*np.diff(rows.pose[:, :2], axis=0).T)
    moves = np.flatnonzero(path_m > 0.0)
    speed_m_s = 1000.0 * path_m[moves] / np.diff(rows.t_ms)[moves]
    if len(moves) and (usual_m_s := float(np.median(speed_m_s))) > MAX_SPEED_M_S:
        raise InputError(
            f"column t: the robot moves at {usual_m_s:.3g} m/s, more than {MAX_SPEED_M_S:g} m/s",
            where=at(int(moves[0])),
            cure="give t in milliseconds; this looks like seconds: multiply it by 1000",
        )


def check_radians(rows: Rows, at: Where) -> None:
    """Refuse headings beyond a full turn that follow the path as degrees and do not follow it as radians.

    The robot rolls along its heading, forwards or backwards. A heading by another convention follows the path in
    neither unit. A heading that counts full turns, and so exceeds one turn, follows it in radians.

    Raises:
        InputError: The headings are in degrees.
    """
    yaw = rows.pose[:, 2]
    beyond = np.flatnonzero(np.abs(yaw) > 2 * math.pi)
    ends = _chords(rows.pose[:, :2]) if len(beyond) else np.zeros(0, dtype=np.int64)
    if len(ends) <= MAX_UNJUDGED_CHORDS:
        return
    off_rad = _angle_to_path(rows.pose[ends, :2], yaw[ends])
    if off_rad > UNEXPLAINED_RAD and _angle_to_path(rows.pose[ends, :2], np.radians(yaw[ends])) < EXPLAINED_RAD:
        raise InputError(
            "column theta: agrees with the path of x and y only if it is in degrees",
            where=at(int(beyond[0])),
            got=round(float(yaw[beyond[0]]), 6),
            cure="give theta in radians",
        )


def check_on_the_floor(rows: Rows, arena: Arena, look: LookConfig, at: Where) -> None:
    """Refuse images from outside the room, where nothing is visible.

    Raises:
        InputError: There is such an image; the first one is named.
    """
    low, high = floor_bounds(arena, look)
    place = rows.pose[:, :2]
    outside = np.flatnonzero((rows.image > 0) & np.any((place < low) | (place > high), axis=1))
    if not len(outside):
        return
    x, y = place[outside[0]].tolist()
    extent = ", ".join(f"{axis} = {a:.2f} to {b:.2f} m" for axis, a, b in zip("xy", low, high, strict=True))
    raise InputError(
        f"x = {x:g}, y = {y:g} m is outside the room, whose floor extends from {extent}",
        where=at(int(outside[0])),
        cure="give x and y in metres, or a different --arena",
    )


def _chords(place: Array) -> np.ndarray:
    """Return the rows (M,) at the ends of chords; each is the first row that is CHORD_M away from the one before."""
    rows, (last_x, last_y) = [0], place[0].tolist()
    for row, (x, y) in enumerate(place.tolist()):
        if math.hypot(x - last_x, y - last_y) >= CHORD_M:
            rows.append(row)
            last_x, last_y = x, y
    return np.array(rows)


def _angle_to_path(place: Array, yaw_rad: Array) -> float:
    """Return the median angle between chord and mean heading at its ends, the same forwards and backwards."""
    chords = np.diff(place, axis=0)
    # Doubled angles make a heading and its opposite equal; their mean direction is that of the summed unit vectors.
    twice = 2 * (np.arctan2(chords[:, 1], chords[:, 0])[:, None] - np.stack([yaw_rad[:-1], yaw_rad[1:]], axis=1))
    return float(np.median(np.abs(np.angle(np.exp(1j * twice).sum(axis=1)))) / 2)

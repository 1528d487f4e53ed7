"""Suspicious properties of an imported trajectory, with the unit that is suspected."""

import math
from collections.abc import Iterator

import numpy as np

from logs.times import gap_note
from logs.trajectories.path_direction import (
    EXPLAINED_RAD,
    MAX_UNJUDGED_CHORDS,
    UNEXPLAINED_RAD,
    angle_to_path,
    chords,
    turn_to_path,
)
from logs.units.possible_motion import MAX_PATH_WIDTH_M, Where, check_motion
from symolo.core.arrays import Array
from symolo.core.errors import InputError

MAX_USUAL_M_S = 3.0
"""Largest speed that a small robot usually has."""
MIN_USUAL_M_S = 0.002
"""Smallest speed that a small robot usually has; milliseconds that are taken for seconds turn 0.5 m/s into a quarter of
it."""
MAX_USUAL_RAD_S = 15.0
"""Largest rate of turn that a small robot usually has."""
MAX_PLACE_M = 1.1e7
"""Largest coordinate of a place; that of UTM, from the equator to a pole, is 1e7."""
MIN_PATH_M = 0.01
"""Length of the path up to which the robot stands still."""
MAX_GAP_STEPS = 20.0
"""Steps of time above this multiple of the usual step are gaps."""
SAME_STEPS = 0.5
"""Share of steps in which nothing moves from which on poses are repeated: they come less often than rows."""


def check_possible(t_s: Array, pose: Array, at: Where, *, in_milliseconds: bool) -> None:
    """Refuse a motion that no small robot makes, because its units are wrong.

    Args:
        t_s: (N,), times.
        pose: (N, 3), x [m], y [m], yaw [rad], not wrapped.
        at: Place of a row for messages.
        in_milliseconds: Whether the log states its times in milliseconds, as a data.csv does.

    Raises:
        InputError: A place is not on Earth, the robot is too fast, or the headings are in degrees.
    """
    nowhere = np.flatnonzero(np.abs(pose[:, :2]).max(axis=1) > MAX_PLACE_M)
    if len(nowhere):
        row = int(nowhere[0])
        x_m, y_m = pose[row, :2].tolist()
        raise InputError(f"x = {x_m:g}, y = {y_m:g} m is no place on Earth", where=at(row), cure="remove the row")
    mapped = "" if in_milliseconds else ", or write unit: degrees for theta_rad in a mapping file, which --map names"
    _check_headings(pose, at, mapped)
    column = "t"
    cure = "are the times in a larger unit, or the places in a smaller one? name their units in a mapping file"
    if in_milliseconds:
        cure = "give t in milliseconds; this looks like seconds: multiply it by 1000"
        if float(np.ptp(pose[:, :2], axis=0).max()) > MAX_PATH_WIDTH_M:
            column, cure = "x", "give x and y in metres; this looks like millimetres: divide them by 1000"
    check_motion(t_s, pose[:, :2], at, cure, column=column)


def _check_headings(pose: Array, at: Where, mapped: str) -> None:
    """Refuse headings beyond a full turn that follow the path as degrees and do not follow it as radians.

    The robot rolls along its heading, forwards or backwards. A heading by another convention follows the path in
    neither unit. A heading that counts full turns, and so exceeds one turn, follows it in radians.
    """
    yaw = pose[:, 2]
    beyond = np.flatnonzero(np.abs(yaw) > 2 * math.pi)
    ends = chords(pose[:, :2]) if len(beyond) else np.zeros(0, dtype=np.int64)
    if len(ends) <= MAX_UNJUDGED_CHORDS:
        return
    off_rad = angle_to_path(pose[ends, :2], yaw[ends])
    if off_rad > UNEXPLAINED_RAD and angle_to_path(pose[ends, :2], np.radians(yaw[ends])) < EXPLAINED_RAD:
        raise InputError(
            "column theta: agrees with the path of x and y only if it is in degrees",
            where=at(int(beyond[0])),
            got=round(float(yaw[beyond[0]]), 6),
            cure=f"give theta in radians{mapped}",
        )


def trajectory_warnings(t_s: Array, pose: Array) -> tuple[str, ...]:
    """Return what is suspicious about a trajectory from elsewhere; nothing for most.

    Args:
        t_s: (N,), times.
        pose: (N, 3), x [m], y [m], yaw [rad].
    """
    return (*_standing(pose), *_speed(t_s, pose), *_turning(t_s, pose), *_spacing(t_s, pose), *_headings(pose))


def _standing(pose: Array) -> Iterator[str]:
    if float(np.hypot(*np.diff(pose[:, :2], axis=0).T).sum()) < MIN_PATH_M:
        yield "the robot moves less than 1 cm: are x and y in a larger unit than was taken, or did it stand still?"


def _speed(t_s: Array, pose: Array) -> Iterator[str]:
    speed = _usual_rate(np.hypot(*np.diff(pose[:, :2], axis=0).T), t_s)
    if speed > MAX_USUAL_M_S:
        yield (
            f"the robot usually moves at {speed:.3g} m/s, which is fast for a small robot: are the times in a larger"
            " unit than was taken, or the places in a smaller one?"
        )
    elif 0.0 < speed < MIN_USUAL_M_S:
        yield (
            f"the robot usually moves at {speed:.3g} m/s, which is slow for a small robot: are the times in a smaller"
            " unit than was taken, such as milliseconds, or the places in a larger one?"
        )


def _turning(t_s: Array, pose: Array) -> Iterator[str]:
    rate = _usual_rate(np.abs(np.angle(np.exp(1j * np.diff(pose[:, 2])))), t_s)
    if rate > MAX_USUAL_RAD_S:
        yield (
            f"the robot usually turns at {rate:.3g} rad/s, which is fast for a small robot: are the headings in"
            " degrees, or the times in a larger unit than was taken?"
        )


def _usual_rate(changes: Array, t_s: Array) -> float:
    """Return the median of changes (N - 1,) per second over those steps in which something changes."""
    moves = changes > 0.0
    return float(np.median(changes[moves] / np.diff(t_s)[moves])) if moves.any() else 0.0


def _spacing(t_s: Array, pose: Array) -> Iterator[str]:
    if gap := gap_note(t_s, MAX_GAP_STEPS):
        yield gap
    moved = np.any(np.diff(pose, axis=0) != 0.0, axis=1)
    inside = moved[np.argmax(moved) : len(moved) - np.argmax(moved[::-1])] if moved.any() else moved[:0]
    if len(inside) and np.mean(~inside) > SAME_STEPS:
        share = f"{np.mean(~inside):.0%} of the rows between the first and the last motion"
        yield f"{share} repeat the pose above: poses come less often than rows"


def _headings(pose: Array) -> Iterator[str]:
    ends = chords(pose[:, :2])
    if len(ends) <= MAX_UNJUDGED_CHORDS:
        return
    place, yaw = pose[ends, :2], pose[ends, 2]
    off_rad = angle_to_path(place, yaw)
    if off_rad < UNEXPLAINED_RAD:
        return
    others = (
        ("in degrees", "unit: deg", np.radians(yaw)),
        ("in radians", "unit: rad", np.degrees(yaw)),
        ("counted clockwise", "factor: -1", -yaw),
    )
    for name, cure, other in others:
        if angle_to_path(place, other) < EXPLAINED_RAD:
            yield (
                f"the headings do not follow the path; they would if they were {name}: give theta_rad {cure} in a"
                " mapping file"
            )
            return
    for sense, factor, signed in (("", "", yaw), (" clockwise from another direction", "factor: -1 and ", -yaw)):
        turn_rad = turn_to_path(place, signed)
        if angle_to_path(place, signed + turn_rad) < EXPLAINED_RAD:
            counted = f"counted{sense}" if sense else f"larger by {math.degrees(turn_rad):.0f} degrees"
            yield (
                f"the headings do not follow the path; they would if they were {counted}: give theta_rad {factor}"
                f"offset: {turn_rad:.4g} in a mapping file"
            )
            return
    yield (
        f"the headings do not follow the path: the median angle between them is {math.degrees(off_rad):.0f} degrees; a"
        " robot with two wheels drives along its heading"
    )

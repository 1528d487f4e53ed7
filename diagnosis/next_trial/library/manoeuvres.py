"""Manoeuvres of a drive that end where they begin, in a given time and on a given floor.

Each consists of legs that begin and end at rest, and have a constant curvature, so that the path is one of exact arcs
and straight lines. As every manoeuvre ends at the pose at which it begins, any sequence of them stays on the floor.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil, degrees, pi

import numpy as np

from diagnosis.importers.drive_log import ROW_S
from symolo.core.arrays import Array
from symolo.core.progress import plural

SHARES = (1.0, 0.5, 0.2)
"""Speeds of a manoeuvre, relative to the highest."""
RADII = (1.0, 2.0, 4.0)
"""Radii of arcs, relative to the distance between the wheels."""
RAMP_ROWS = 4
"""Rows in which a leg reaches its speed, and in which it stops again."""
SHORT_ROWS = 10
"""Rows of a short push, which shows delays."""
MIN_ROWS = 2 * RAMP_ROWS
MAX_REPEATS = 12
SIDES = ((1.0, "left"), (-1.0, "right"))
DECIMALS = 4


@dataclass(frozen=True)
class Leg:
    """A part of a path, from rest to rest."""

    v_m_s: float
    """Forward speed between the ramps."""
    w_rad_s: float
    """Yaw rate between the ramps, counter-clockwise."""
    rows: int


@dataclass(frozen=True)
class Reach:
    """What a robot can do on a floor."""

    rows: int
    """Rows of each manoeuvre."""
    speed_m_s: float
    """Highest speed of a wheel over the floor."""
    turn_rad_s: float
    """Highest yaw rate."""
    track_m: float
    """Distance between the wheels."""
    half_floor_m: tuple[float, float]
    """Distance from the start to the border, forward and sideways, that the middle of the axle may go."""


@dataclass(frozen=True, eq=False)
class Manoeuvre:
    """A closed path."""

    title: str
    commands: Array
    """(N, 2), forward speed [m/s] and yaw rate [rad/s] from each row to the next one."""


def manoeuvres(reach: Reach) -> Iterator[Manoeuvre]:
    """Yield the manoeuvres that fit the floor, at each speed."""
    for share in SHARES:
        speed_m_s = share * reach.speed_m_s
        turn_rad_s = min(share * reach.turn_rad_s, 2.0 * speed_m_s / reach.track_m)
        for attempts in _shapes(reach, speed_m_s, turn_rad_s):
            fitting = (each for title, legs in attempts for each in _fitting(reach, title, legs))
            if (first := next(fitting, None)) is not None:
                yield first


def path_of(commands: Array, start: Array) -> Array:
    """Return the poses (N + 1, 3) along commands (N, 2) from a start (3,): x [m], y [m], yaw [rad]."""
    forward_m, turned_rad = ROW_S * commands.T
    yaw = start[2] + np.concatenate([[0.0], np.cumsum(turned_rad)])
    # The chord of an arc; a turn of zero has the length of the arc.
    chord_m = forward_m * np.sinc(turned_rad / (2.0 * pi))
    middle = yaw[:-1] + 0.5 * turned_rad
    steps = np.stack([chord_m * np.cos(middle), chord_m * np.sin(middle)], axis=-1)
    places = start[:2] + np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    return np.concatenate([places, yaw[:, None]], axis=-1)


Attempts = Iterator[tuple[str, Sequence[Leg]]]
"""Forms of one manoeuvre with their titles, the largest first; the first that fits the floor is taken."""


def _shapes(reach: Reach, v: float, w: float) -> Iterator[Attempts]:
    """Yield the variants of each manoeuvre, the preferred one first; a new manoeuvre is a line here.

    No leg exceeds the speed [m/s] and the yaw rate [rad/s].
    """
    at = f"at {v:.2g} m/s"
    yield _there_and_back(reach, f"straight ahead and back {at}", [(v, 0.0)])
    yield _there_and_back(reach, f"a turn on the spot to the left and back at {w:.2g} rad/s", [(0.0, w)])
    yield _pushes(reach, f"short pushes ahead and back {at}", v, 0.0)
    yield _pushes(reach, f"short turns to the left and back at {w:.2g} rad/s", 0.0, w)
    for sign, side in SIDES:
        yield _spins(reach, side, sign * w)
        for radius in RADII:
            radius_m = radius * reach.track_m
            arc = _arc(reach, radius_m, v, sign * w)
            title = f"an arc to the {side} and back, radius {radius_m:.2g} m, at {arc[0]:.2g} m/s"
            yield _there_and_back(reach, title, [arc])
        yield _circles(reach, side, v, sign * w)
        yield _squares(reach, side, v, sign * w)
    left, right = (_arc(reach, 2.0 * reach.track_m, v, sign * w) for sign, _ in SIDES)
    yield _there_and_back(reach, f"an S-curve and back at {left[0]:.2g} m/s", [left, right])
    yield _eights(reach, v, w)


def _there_and_back(reach: Reach, title: str, speeds: Sequence[tuple[float, float]]) -> Attempts:
    """Yield legs with some speeds and the same legs in reverse; each further variant repeats shorter legs more
    often.
    """
    for repeats in range(1, MAX_REPEATS + 1):
        rows = reach.rows // (2 * len(speeds) * repeats)
        if rows < MIN_ROWS:
            return
        there = [Leg(v, w, rows) for v, w in speeds]
        back = [Leg(-v, -w, rows) for v, w in reversed(speeds)]
        yield title + _angle(there) + _times(repeats), (there + back) * repeats


def _pushes(reach: Reach, title: str, v: float, w: float) -> Attempts:
    """Yield one variant: short legs forward and in reverse, as many as the time allows."""
    pair = [Leg(v, w, SHORT_ROWS), Leg(-v, -w, SHORT_ROWS)]
    yield title + _angle(pair[:1]), pair * (reach.rows // (2 * SHORT_ROWS))


def _spins(reach: Reach, side: str, w: float) -> Attempts:
    """Yield one variant: turning on the spot, by the largest number of whole turns that the time allows."""
    possible = _turned(reach.rows, abs(w)) / (2.0 * pi)
    if turns := int(possible):
        rate = w * turns / possible
        yield (
            f"turning on the spot to the {side} at {abs(rate):.2g} rad/s, {plural(turns, 'whole turn')}",
            [Leg(0.0, rate, reach.rows)],
        )


def _circles(reach: Reach, side: str, v: float, w: float) -> Attempts:
    """Yield circles; each further variant has one circle more, and smaller ones."""
    for circles in range(1, MAX_REPEATS + 1):
        rate = 2.0 * pi * circles / _turned(reach.rows, 1.0)
        speed = _inner(reach, v, rate)
        if rate > abs(w) or speed <= 0.0:
            return
        title = f"a circle to the {side}, radius {speed / rate:.2g} m, at {speed:.2g} m/s{_times(circles)}"
        yield title, [Leg(speed, np.copysign(rate, w), reach.rows)]


def _eights(reach: Reach, v: float, w: float) -> Attempts:
    """Yield figures eight; each further variant has one more, and smaller ones."""
    for eights in range(1, MAX_REPEATS + 1):
        rows = reach.rows // (2 * eights)
        if rows <= MIN_ROWS:
            return
        rate = 2.0 * pi / _turned(rows, 1.0)
        speed = _inner(reach, v, rate)
        if rate > w or speed <= 0.0:
            return
        title = f"a figure eight, radius {speed / rate:.2g} m, at {speed:.2g} m/s{_times(eights)}"
        yield title, [Leg(speed, rate, rows), Leg(speed, -rate, rows)] * eights


def _squares(reach: Reach, side: str, v: float, w: float) -> Attempts:
    """Yield squares with turns on the spot, from the largest to the smallest.

    They are those of UMBmark (Borenstein and Feng, IEEE Trans. Robotics and Automation 12 (1996) 869).
    """
    corner = ceil(0.5 * pi / (abs(w) * ROW_S)) + RAMP_ROWS - 1
    straight = reach.rows // 4 - corner
    if straight < MIN_ROWS:
        return
    longest = _turned(straight, v)
    for share in (1.0, 0.7, 0.5, 0.35):
        speed, edge_m = share * v, share * longest
        turn = Leg(0.0, np.copysign(0.5 * pi / _turned(corner, 1.0), w), corner)
        yield (
            f"a square to the {side}, edges of {edge_m:.2g} m, at {speed:.2g} m/s",
            [Leg(speed, 0.0, straight), turn] * 4,
        )


def _arc(reach: Reach, radius_m: float, v: float, w: float) -> tuple[float, float]:
    """Return speed and yaw rate of an arc in which the outer wheel is not faster than v."""
    speed = min(v / (1.0 + 0.5 * reach.track_m / radius_m), abs(w) * radius_m)
    return speed, np.copysign(speed / radius_m, w)


def _inner(reach: Reach, v: float, rate: float) -> float:
    """Return the speed of the middle of the axle at which the outer wheel has the speed v."""
    return v - 0.5 * reach.track_m * rate


def _turned(rows: int, speed: float) -> float:
    """Return how far a leg goes with a speed between its ramps."""
    return speed * ROW_S * (rows - RAMP_ROWS + 1)


def _angle(legs: Sequence[Leg]) -> str:
    """Return the angle of a turn on the spot in words; nothing for other legs."""
    if any(leg.v_m_s for leg in legs):
        return ""
    return f", by {degrees(sum(_turned(leg.rows, abs(leg.w_rad_s)) for leg in legs)):.0f} degrees"


def _times(number: int) -> str:
    return "" if number == 1 else f", {number} times"


def _fitting(reach: Reach, title: str, legs: Sequence[Leg]) -> Iterator[Manoeuvre]:
    """Yield the legs as a manoeuvre if they stay on the floor; the robot rests for the time that they leave."""
    commands = np.zeros((reach.rows, 2))
    row = 0
    for leg in legs:
        ramps = np.convolve(np.ones(leg.rows - RAMP_ROWS + 1), np.full(RAMP_ROWS, 1.0 / RAMP_ROWS))
        commands[row : row + leg.rows] = ramps[:, None] * (leg.v_m_s, leg.w_rad_s)
        row += leg.rows
    commands = np.round(commands, DECIMALS)
    away = np.abs(path_of(commands, np.zeros(3))[:, :2]).max(axis=0)
    if np.all(away <= reach.half_floor_m):
        yield Manoeuvre(title, commands)

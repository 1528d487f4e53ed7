"""Curves through points, as the straights and arcs of a line: each piece begins in the direction of the one before."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from symolo.core.arrays import Array

if TYPE_CHECKING:
    from scipy.interpolate import BPoly, CubicSpline

Point = tuple[float, float]
Curve: TypeAlias = "CubicSpline | BPoly"
Piece = dict[str, object]
"""A piece of a line, as an arena file has it."""

TOLERANCE_M = 5e-5
"""Largest distance of the arcs from a curve, where it is measured; elsewhere it may be twice as large."""
MIN_RADIUS_M, MAX_RADIUS_M = 0.02, 5.0
"""Radii of the arcs that the schema allows; a flatter arc becomes a straight."""
DIGITS = 7
"""Decimals of lengths [m] and angles [deg]."""
_SAME_M = 1e-3
"""Distance below which two points are the same."""
_SPLINE_STEP_M = 5e-3
"""Smallest distance between the points of a spline. Two arcs lie between them, and no piece may be almost a point."""
_FLAT_RAD = math.radians(0.1)
"""Turn below which a corner is none."""
_PARTS = 8
"""Number of parts of a span within which its distance from the arcs is measured."""
_MAX_HALVINGS = 12


class UnfitError(Exception):
    """No line can be laid along the points."""

    def __init__(self, problem: str, cure: str) -> None:
        super().__init__(problem)
        self.cure = cure


def rounded(points: Sequence[Point], radius_m: float, *, closed: bool) -> list[Piece]:
    """Return straights from point to point with an arc of `radius_m` at each corner.

    An arc replaces the last r tan(turn / 2) of both edges at its corner.

    Raises:
        UnfitError: Two successive points are the same, or an edge is too short for the arcs at its ends.
    """
    corners = _distinct(points, closed=closed)
    edges = np.diff(np.vstack([corners, corners[:1]]) if closed else corners, axis=0)
    length = np.hypot(edges[:, 0], edges[:, 1])
    yaw = np.arctan2(edges[:, 1], edges[:, 0])
    turn = (yaw - np.roll(yaw, 1) + np.pi) % (2 * np.pi) - np.pi  # at the first point of each edge
    if not closed:
        turn[0] = 0.0
    turn[np.abs(turn) < _FLAT_RAD] = 0.0
    taken = radius_m * np.tan(0.5 * np.abs(turn))
    after = np.append(taken[1:], taken[0] if closed else 0.0)
    needed = taken + after
    if (short := np.flatnonzero(needed > length + 1e-9)).size:
        first, fits_m = int(short[0]), radius_m * float(np.min(length[short] / needed[short]))
        cure = f"write bend_radius_m: {math.floor(1000 * fits_m) / 1000:g} or less, or move the points"
        if fits_m < MIN_RADIUS_M:
            cure = "move the points apart, or turn less sharply there"
        where = _text(corners[first])
        raise UnfitError(
            f"bends of {radius_m:g} m do not fit between point {first + 1} at {where} and the next one", cure
        )
    pieces: list[Piece] = []
    for k in range(len(edges)):
        along = edges[k] / length[k]
        start, end = corners[k] + taken[k] * along, corners[k] + (length[k] - after[k]) * along
        if turn[k]:
            pieces.append(_arc(start, float(yaw[k]), float(turn[k]), radius_m))
        if math.dist(start, end) > _SAME_M:
            pieces.append(_straight(start, end))
    # A closed line begins with the straight behind its first point.
    return [*pieces[1:], pieces[0]] if closed and turn[0] else pieces


def _arc(end: Array, yaw_rad: float, turn_rad: float, radius_m: float) -> Piece:
    """Return the arc that ends at a point in a direction after a turn."""
    side = math.copysign(1.0, turn_rad)
    center = end + side * radius_m * np.array([-math.sin(yaw_rad), math.cos(yaw_rad)])
    end_rad = yaw_rad - side * 0.5 * math.pi
    return _arc_piece(center, radius_m, end_rad - turn_rad, turn_rad)


def spline(points: Sequence[Point], *, closed: bool) -> list[Piece]:
    """Return a smooth curve through the points, as arcs within 0.1 mm of a cubic spline.

    The parameter of the spline grows with the square root of the distance between points, which avoids loops at
    uneven distances (centripetal parameters, Lee 1989, https://doi.org/10.1016/0010-4485(89)90003-1). Two arcs with
    the directions of the spline at their ends stand for each part of it (biarcs), laid as one strip without joints.

    Raises:
        UnfitError: Two successive points are too close, there are too few, or the curve bends too tightly.
    """
    from scipy.interpolate import CubicSpline  # noqa: PLC0415 - most arenas have no spline

    through = _distinct(points, closed=closed)
    if closed:
        through = np.vstack([through, through[:1]])
    if len(through) < 3:
        raise UnfitError("a spline through two points is a straight", "write shape: rounded, or more points")
    apart_m = np.hypot(*np.diff(through, axis=0).T)
    if (close := np.flatnonzero(apart_m < _SPLINE_STEP_M)).size:
        k = int(close[0])
        where = f"point {k + 1} at {_text(through[k])}"
        problem = f"{where} and the next one are {1000 * apart_m[k]:.2g} mm apart"
        raise UnfitError(problem, f"leave out points until all are {1000 * _SPLINE_STEP_M:g} mm apart or more")
    steps = np.sqrt(apart_m)
    at = np.concatenate(([0.0], np.cumsum(steps)))
    return along(CubicSpline(at, through, bc_type="periodic" if closed else "natural"), at)


def along(curve: Curve, at: Sequence[float] | Array) -> list[Piece]:
    """Return joined arcs within 0.1 mm of a curve.

    Args:
        curve: Function of parameters (N,) and of the order of the derivative, 0 or 1; returns (N, 2).
        at: Parameters (N,) between which the curve has no corner.

    Raises:
        UnfitError: The curve bends too tightly, or turns back.
    """
    first, *others = (arc for begin, end in pairwise(at) for arc in _arcs(curve, begin, end, _MAX_HALVINGS))
    return [first, *({**arc, "joined": True} for arc in others)]


def _arcs(curve: Curve, begin: float, end: float, halvings: int) -> Iterator[Piece]:
    """Yield arcs for a part of a spline, in halves where two arcs are too far from it."""
    both = _biarc(curve, begin, end)
    inner = curve(np.linspace(begin, end, _PARTS + 1)[1:-1])
    if both is None or max(min(_distance(arc, point) for arc in both) for point in inner) > TOLERANCE_M:
        middle = 0.5 * (begin + end)
        if not halvings:
            raise UnfitError(f"the curve turns back at {_text(curve(middle))}", "move the points there")
        yield from _arcs(curve, begin, middle, halvings - 1)
        yield from _arcs(curve, middle, end, halvings - 1)
        return
    for start, stop, yaw_rad in both:
        chord = stop - start
        turn_rad = 2 * _wrapped(math.atan2(chord[1], chord[0]) - yaw_rad)
        radius_m = math.inf if turn_rad == 0 else 0.5 * math.hypot(*chord) / abs(math.sin(0.5 * turn_rad))
        if radius_m < MIN_RADIUS_M:
            problem = f"the curve bends to a radius of {1000 * radius_m:.2g} mm at {_text(start)}"
            raise UnfitError(problem, f"move the points so that no radius is below {1000 * MIN_RADIUS_M:g} mm")
        if radius_m > MAX_RADIUS_M or abs(turn_rad) < _FLAT_RAD:
            yield _straight(start, stop)
        else:
            yield _arc(stop, yaw_rad + turn_rad, turn_rad, radius_m)


Arc = tuple[Array, Array, float]
"""First and last point (2,) of an arc, and the direction at its first point [rad]."""


def _biarc(curve: Curve, begin: float, end: float) -> tuple[Arc, Arc] | None:
    """Return two arcs that join and have the directions of the curve at both ends; None where the curve turns back.

    Both tangents have the length d, with 2 (1 - t0 t1) d^2 + 2 v (t0 + t1) d = v v for the chord v.
    """
    (p0, p1), (t0, t1) = curve([begin, end]), curve([begin, end], 1)
    if not (t0.any() and t1.any()):
        return None
    t0, t1 = t0 / math.hypot(*t0), t1 / math.hypot(*t1)
    v = p1 - p0
    a, b, c = 2 * (1 - float(t0 @ t1)), 2 * float(v @ (t0 + t1)), float(v @ v)
    if b <= 0.0:
        return None
    d = 2 * c / (b + math.sqrt(b * b + 4 * a * c))  # the positive root, exact where a is near 0
    joint = 0.5 * (p0 + p1 + d * (t0 - t1))
    middle = v - d * (t0 + t1)  # from the end of the first tangent to the begin of the second
    if not middle.any():
        return None
    return (p0, joint, math.atan2(t0[1], t0[0])), (joint, p1, math.atan2(middle[1], middle[0]))


def _distance(arc: Arc, point: Array) -> float:
    """Return the distance of a point from the circle, or the straight, of an arc; infinite beyond its ends."""
    start, stop, yaw_rad = arc
    chord = stop - start
    along = float((point - start) @ chord) / float(chord @ chord)
    if not -0.01 <= along <= 1.01:
        return math.inf
    left = np.array([-math.sin(yaw_rad), math.cos(yaw_rad)])
    across = 2 * float(left @ chord)
    if abs(across) < 1e-9 * math.hypot(*chord):
        return abs(float(left @ (point - start)))
    radius = float(chord @ chord) / across  # signed
    return abs(math.dist(point, start + radius * left) - abs(radius))


def _distinct(points: Sequence[Point], *, closed: bool) -> Array:
    """Return the points (N, 2); the last one of a closed course may repeat the first one.

    Raises:
        UnfitError: Two successive points are the same.
    """
    if closed and len(points) > 1 and math.dist(points[0], points[-1]) < _SAME_M:
        points = points[:-1]
    if closed and len(points) < 3:
        raise UnfitError("a closed line has at least three points", "write more points, or closed: false")
    for number, (here, there) in enumerate(pairwise(points), start=1):
        if math.dist(here, there) < _SAME_M:
            raise UnfitError(f"points {number} and {number + 1} are the same, {_text(here)}", "remove one of them")
    return np.array(points, dtype=float)


def _straight(start: Array, end: Array) -> Piece:
    return {"kind": "straight", "start": _plain(start), "end": _plain(end)}


def _arc_piece(center: Array, radius_m: float, start_rad: float, turn_rad: float) -> Piece:
    start_deg = math.degrees(_wrapped(start_rad))
    return {
        "kind": "arc",
        "center": _plain(center),
        "radius_m": round(radius_m, DIGITS),
        "start_deg": round(start_deg, DIGITS),
        "end_deg": round(start_deg + math.degrees(turn_rad), DIGITS),
    }


def _wrapped(angle_rad: float) -> float:
    return (angle_rad + math.pi) % (2 * math.pi) - math.pi


def _plain(point: Array) -> list[float]:
    return [round(float(value), DIGITS) + 0.0 for value in point]


def _text(point: Sequence[float] | Array) -> str:
    return f"({point[0]:.3g}, {point[1]:.3g})"

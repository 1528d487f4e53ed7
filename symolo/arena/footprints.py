"""Rectangles of walls and obstacles on the floor: the one place that computes them from the configuration."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from symolo.arena.forms import ObstacleForm, WallForm

Point = tuple[float, float]

_TURN_RAD = math.radians(5.0)
"""Largest turn that one outline of a swept rectangle contains."""


@dataclass(frozen=True)
class Rectangle:
    """A rectangle on the floor."""

    center: Point
    size: tuple[float, float]
    """Lengths along its own x and y [m]."""
    yaw_rad: float

    def corners(self) -> tuple[Point, Point, Point, Point]:
        """Return the corners, x and y [m] in W, counter-clockwise."""
        c, s = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        half_x, half_y = self.size[0] / 2, self.size[1] / 2

        def corner(x: float, y: float) -> Point:
            return (self.center[0] + c * x - s * y, self.center[1] + s * x + c * y)

        return corner(-half_x, -half_y), corner(half_x, -half_y), corner(half_x, half_y), corner(-half_x, half_y)


def wall_footprint(wall: WallForm) -> Rectangle:
    """Return the footprint of a wall, which lies to the right of its face as seen from start to end."""
    along_x, along_y = wall.end[0] - wall.start[0], wall.end[1] - wall.start[1]
    length = math.hypot(along_x, along_y)
    right_x, right_y = along_y / length, -along_x / length
    half = wall.thickness_m / 2
    center = (
        (wall.start[0] + wall.end[0]) / 2 + half * right_x,
        (wall.start[1] + wall.end[1]) / 2 + half * right_y,
    )
    return Rectangle(center, (length, wall.thickness_m), math.atan2(along_y, along_x))


def obstacle_footprint(obstacle: ObstacleForm) -> Rectangle:
    """Return the footprint of an obstacle at t = 0."""
    return Rectangle(obstacle.center, obstacle.size[:2], math.radians(obstacle.yaw_deg))


def stations(obstacle: ObstacleForm) -> tuple[tuple[float, Rectangle], ...]:
    """Return the times [s] and footprints between which an obstacle moves at constant speed; the first is at t = 0."""
    start = obstacle_footprint(obstacle)
    later = obstacle.motion.waypoints if obstacle.motion else ()
    return (
        (0.0, start),
        *(
            (
                point.t_s,
                Rectangle(
                    (start.center[0] + point.offset[0], start.center[1] + point.offset[1]),
                    start.size,
                    start.yaw_rad + math.radians(point.turn_deg),
                ),
            )
            for point in later
        ),
    )


def swept(one: Rectangle, other: Rectangle) -> list[tuple[Point, ...]]:
    """Return convex outlines that together contain a rectangle on its path to another place, with a few degrees each.

    Without a turn the outline is exact; with one, it lies within a thousandth of the rectangle's diagonal of it.
    """
    parts = max(1, math.ceil(abs(other.yaw_rad - one.yaw_rad) / _TURN_RAD))
    on_the_way = [_between(one, other, part / parts) for part in range(parts + 1)]
    return [convex_outline((*a.corners(), *b.corners())) for a, b in pairwise(on_the_way)]


def _between(one: Rectangle, other: Rectangle, share: float) -> Rectangle:
    x, y = (a + share * (b - a) for a, b in zip(one.center, other.center, strict=True))
    return Rectangle((x, y), one.size, one.yaw_rad + share * (other.yaw_rad - one.yaw_rad))


def convex_outline(points: Iterable[Point]) -> tuple[Point, ...]:
    """Return the corners of the convex hull, counter-clockwise (Andrew's monotone chain)."""
    ordered = sorted(set(points))
    halves: list[list[Point]] = []
    for direction in (ordered, ordered[::-1]):
        half: list[Point] = []
        for point in direction:
            while len(half) > 1 and _left_turn(half[-2], half[-1], point) <= 0:
                half.pop()
            half.append(point)
        halves.append(half[:-1])
    return (*halves[0], *halves[1])


def _left_turn(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def overlap(one: Rectangle, other: Rectangle) -> bool:
    """Return whether two rectangles share area."""
    if math.dist(one.center, other.center) > 0.5 * (math.hypot(*one.size) + math.hypot(*other.size)):
        return False  # the circles around them do not meet, which is quick to see
    return outlines_overlap(one.corners(), other.corners())


def outlines_overlap(one: Sequence[Point], other: Sequence[Point]) -> bool:
    """Return whether two convex outlines share area: no side of either separates them (separating axis theorem)."""
    both = one, other
    for outline in both:
        for (x0, y0), (x1, y1) in pairwise((*outline, outline[0])):
            axis = (y1 - y0, x0 - x1)
            shadow, other_shadow = ([axis[0] * x + axis[1] * y for x, y in corners] for corners in both)
            if max(shadow) <= min(other_shadow) or max(other_shadow) <= min(shadow):
                return False
    return True

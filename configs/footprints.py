"""Rectangles on the floor, just enough to tell whether a robot would start inside something."""

import math
from itertools import pairwise

from configs.schema.arena import Wall

Point = tuple[float, float]
Corners = tuple[Point, Point, Point, Point]


def corners(center: Point, size: tuple[float, ...], yaw_deg: float) -> Corners:
    """Corners of a rectangle of size (along its own x, along its own y) [m], counter-clockwise."""
    c, s = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    half_x, half_y = size[0] / 2, size[1] / 2

    def corner(x: float, y: float) -> Point:
        return (center[0] + c * x - s * y, center[1] + s * x + c * y)

    return corner(-half_x, -half_y), corner(half_x, -half_y), corner(half_x, half_y), corner(-half_x, half_y)


def wall_corners(wall: Wall) -> Corners:
    """Corners of a wall's body, which lies to the right of start -> end."""
    along_x, along_y = wall.end[0] - wall.start[0], wall.end[1] - wall.start[1]
    length = math.hypot(along_x, along_y)
    right_x, right_y = along_y / length * wall.thickness_m, -along_x / length * wall.thickness_m
    (x0, y0), (x1, y1) = wall.start, wall.end
    return (x0 + right_x, y0 + right_y), (x1 + right_x, y1 + right_y), (x1, y1), (x0, y0)


def overlap(one: Corners, other: Corners) -> bool:
    """Whether two rectangles share area: no side of either separates them (separating axis theorem)."""
    for rectangle in (one, other):
        for (x0, y0), (x1, y1) in pairwise(rectangle):
            axis = (y1 - y0, x0 - x1)
            shadow, other_shadow = (sorted(axis[0] * x + axis[1] * y for x, y in shape) for shape in (one, other))
            if shadow[-1] <= other_shadow[0] or other_shadow[-1] <= shadow[0]:
                return False
    return True

"""Where walls and obstacles stand on the floor: the one place that turns their configuration into rectangles."""

import math
from dataclasses import dataclass
from itertools import pairwise

from configs.schema.arena import Obstacle, Wall

Point = tuple[float, float]


@dataclass(frozen=True)
class Rectangle:
    center: Point
    size: tuple[float, float]
    """Along its own x and y [m]."""
    yaw_rad: float

    def corners(self) -> tuple[Point, Point, Point, Point]:
        """Counter-clockwise [m]."""
        c, s = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        half_x, half_y = self.size[0] / 2, self.size[1] / 2

        def corner(x: float, y: float) -> Point:
            return (self.center[0] + c * x - s * y, self.center[1] + s * x + c * y)

        return corner(-half_x, -half_y), corner(half_x, -half_y), corner(half_x, half_y), corner(-half_x, half_y)


def wall_footprint(wall: Wall) -> Rectangle:
    """The body of a wall, which lies to the right of start -> end."""
    along_x, along_y = wall.end[0] - wall.start[0], wall.end[1] - wall.start[1]
    length = math.hypot(along_x, along_y)
    right_x, right_y = along_y / length, -along_x / length
    half = wall.thickness_m / 2
    center = (
        (wall.start[0] + wall.end[0]) / 2 + half * right_x,
        (wall.start[1] + wall.end[1]) / 2 + half * right_y,
    )
    return Rectangle(center, (length, wall.thickness_m), math.atan2(along_y, along_x))


def obstacle_footprint(obstacle: Obstacle) -> Rectangle:
    return Rectangle(obstacle.center, obstacle.size[:2], math.radians(obstacle.yaw_deg))


def overlap(one: Rectangle, other: Rectangle) -> bool:
    """Whether two rectangles share area: no side of either separates them (separating axis theorem)."""
    both = one.corners(), other.corners()
    for rectangle in both:
        for (x0, y0), (x1, y1) in pairwise(rectangle):
            axis = (y1 - y0, x0 - x1)
            shadow, other_shadow = (sorted(axis[0] * x + axis[1] * y for x, y in corners) for corners in both)
            if shadow[-1] <= other_shadow[0] or other_shadow[-1] <= shadow[0]:
                return False
    return True

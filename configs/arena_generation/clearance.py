"""Geometry of the room around a line: distances, the view of range sensors, and parts of the line that are too close.

The sensors are those of the robot `nominal`. The settings of the scenario's robot are not used, so that a random robot
does not change the arena. For other robots, change `ArenaGenerator.clearance`.
"""

import math
from functools import lru_cache
from itertools import pairwise

import numpy as np

from symolo.arena.footprints import Rectangle
from symolo.core.arrays import Array
from symolo.core.geometry.poses import PlanarPose

FRONT_SENSOR: PlanarPose = (0.085, 0.0, 0.0)
"""x [m], y [m], yaw [rad] in R."""
LEFT_SENSOR: PlanarPose = (0.075, 0.03, math.radians(45))
RIGHT_SENSOR: PlanarPose = (0.075, -0.03, math.radians(-45))
HALF_FIELD_RAD = math.radians(12.5)
"""Half of the field of view of a range sensor."""
HEADING_RAD = math.radians(10)
"""Largest angle between the heading of a robot on the line and its tangent."""
OUTLINE_SPACING_M = 0.01


def distance_to(rectangle: Rectangle, points: Array) -> Array:
    """Return the distances (N,) [m] from points (N, 2) to a rectangle; 0 inside."""
    local = in_frame_of((*rectangle.center, rectangle.yaw_rad), points)
    beyond = np.maximum(np.abs(local) - 0.5 * np.array(rectangle.size), 0.0)
    return np.hypot(beyond[:, 0], beyond[:, 1])


def in_frame_of(frame: PlanarPose, points: Array) -> Array:
    """Return points (N, 2) of W in the frame of a pose in W."""
    x, y, yaw = frame
    c, s = math.cos(yaw), math.sin(yaw)
    return (points - (x, y)) @ np.array([[c, -s], [s, c]])


@lru_cache(64)
def outline_of(rectangle: Rectangle) -> Array:
    """Return points (N, 2) on the outline of a rectangle, including its corners; read-only.

    The walls and boxes of an arena are asked for again with every further box.
    """
    corners = np.array(rectangle.corners())
    parts = []
    for begin, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        count = max(1, math.ceil(math.dist(begin, end) / OUTLINE_SPACING_M))
        parts.append(begin + np.arange(count)[:, None] / count * (end - begin))
    outline = np.concatenate(parts)
    outline.flags.writeable = False
    return outline


def seen_m(poses: Array, sensor: PlanarPose, half_angle_rad: float, points: Array) -> Array:
    """Return the distance from a sensor to the nearest of points (M, 2) in its cone, for each robot pose (N, 3).

    It is infinite if no point is in the cone.
    """
    if not len(points):
        return np.full(len(poses), np.inf)
    distance, bearing = _polar(poses, sensor, points)
    return np.where(np.abs(bearing) <= half_angle_rad, distance, np.inf).min(axis=1)


def blocked_m(pose: Array, sensor: PlanarPose, half_angle_rad: float, points: Array) -> float:
    """Return the distance within which every direction of a sensor's cone is blocked; infinite if there is a gap."""
    distance, bearing = _polar(pose[None], sensor, points)
    sectors = np.linspace(-half_angle_rad, half_angle_rad, 9)
    nearest = [distance[(bearing >= low) & (bearing < high)].min(initial=np.inf) for low, high in pairwise(sectors)]
    return float(max(nearest))


def _polar(poses: Array, sensor: PlanarPose, points: Array) -> tuple[Array, Array]:
    """Return distance [m] and angle from a sensor's axis [rad], (N, M) each, of points (M, 2) at robot poses (N, 3)."""
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    x = poses[:, 0] + c * sensor[0] - s * sensor[1]
    y = poses[:, 1] + s * sensor[0] + c * sensor[1]
    dx, dy = points[:, 0] - x[:, None], points[:, 1] - y[:, None]
    bearing = np.arctan2(dy, dx) - (poses[:, 2] + sensor[2])[:, None]
    return np.hypot(dx, dy), (bearing + np.pi) % (2 * np.pi) - np.pi


def comes_near_itself(points: Array, spacing_m: float, min_m: float) -> bool:
    """Return whether a closed line (N, 2), sampled evenly, comes within `min_m` of itself.

    Pairs of points do not count if the line between them is no longer than a half circle of the diameter `min_m`. On
    bends with a radius of at least half of `min_m`, all other pairs are further apart.
    """
    nearest = math.floor(0.5 * math.pi * min_m / spacing_m + 1) + 1
    count = len(points)
    x, y = np.ascontiguousarray(np.concatenate([points, points]).T)  # twice around, so that pairs are slices
    # One offset along the line at a time: all pairs of a long line at once would not fit into memory.
    for steps in range(nearest, count // 2 + 1):
        dx, dy = x[steps : steps + count] - x[:count], y[steps : steps + count] - y[:count]
        if (dx * dx + dy * dy).min() < min_m * min_m:
            return True
    return False

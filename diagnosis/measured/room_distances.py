"""Distances from the range sensors of a robot to the walls of an empty rectangular room, along each sensor's axis."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.measured.case_files.nominal import KnownRoom
from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array

WALLS = ("x = 0", "x = room_x_m", "y = 0", "y = room_y_m")
PARALLEL = 1e-12
"""Sine of the angle to a wall below which an axis is parallel to it."""


@dataclass(frozen=True)
class RoomRanges:
    """Where the axes of S sensors hit the walls; all arrays are (..., n, S)."""

    distance_m: Array
    incidence_rad: Array
    """Angle between the axis and the normal of the wall, from 0."""
    tilt_rad: Array
    """Angle between the axis and the normal with its sign, positive if the axis is turned to the left of the normal."""
    wall: NDArray[np.int64]
    """Index of the wall in WALLS."""
    by_x: Array
    """Derivative of the distance by the robot's x [m/m]."""
    by_y: Array
    """Derivative of the distance by the robot's y [m/m]."""
    by_yaw: Array
    """Derivative of the distance by the robot's heading [m/rad]."""
    hit_x_m: Array
    hit_y_m: Array
    axis_rad: Array
    """Direction of the sensor's axis in W."""


def room_ranges(room: KnownRoom, pose: Array, mount_x_m: Array, mount_y_m: Array, mount_yaw_rad: Array) -> RoomRanges:
    """Return where the axes of the sensors hit the walls.

    Args:
        room: 0 <= x <= room_x_m, 0 <= y <= room_y_m.
        pose: (..., n, 3), x [m], y [m], yaw [rad] of the axle.
        mount_x_m: (S,) or broadcast, forward of the axle.
        mount_y_m: (S,) or broadcast, to the left.
        mount_yaw_rad: (S,) or broadcast, counter-clockwise from straight ahead.
    """
    yaw = pose[..., 2:]
    cos_yaw, sin_yaw = np.cos(yaw), np.sin(yaw)
    ahead_x, ahead_y = cos_yaw * mount_x_m - sin_yaw * mount_y_m, sin_yaw * mount_x_m + cos_yaw * mount_y_m
    x, y, axis = pose[..., :1] + ahead_x, pose[..., 1:2] + ahead_y, yaw + mount_yaw_rad
    # An axis parallel to a wall would hit it far away, so that another wall is nearer.
    c, s = (np.where(np.abs(x) < PARALLEL, PARALLEL, x) for x in (np.cos(axis), np.sin(axis)))
    to_x = (np.where(c > 0.0, room.room_x_m, 0.0) - x) / c
    to_y = (np.where(s > 0.0, room.room_y_m, 0.0) - y) / s
    is_x = ~(to_y < to_x)
    distance = np.where(is_x, to_x, to_y)
    # A turn of the robot moves the mount and sweeps the axis along the wall.
    swing = np.where(is_x, (ahead_y + distance * s) / c, -(ahead_x + distance * c) / s)
    zero = np.zeros_like(distance)
    return RoomRanges(
        distance_m=distance,
        incidence_rad=np.arccos(np.clip(np.abs(np.where(is_x, c, s)), 0.0, 1.0)),
        tilt_rad=np.where(is_x, np.arctan2(np.sign(c) * s, np.abs(c)), np.arctan2(-np.sign(s) * c, np.abs(s))),
        wall=np.where(is_x, np.where(c > 0.0, 1, 0), np.where(s > 0.0, 3, 2)),
        by_x=np.where(is_x, -1.0 / c, zero),
        by_y=np.where(is_x, zero, -1.0 / s),
        by_yaw=swing,
        hit_x_m=x + distance * c,
        hit_y_m=y + distance * s,
        axis_rad=axis,
    )


def near_corner(room: KnownRoom, ranges: RoomRanges, within_m: float, within_rad: float) -> Mask:
    """Return whether a ray ends near a corner or points almost at one, (..., n, S)."""
    c, s = np.cos(ranges.axis_rad), np.sin(ranges.axis_rad)
    near = np.zeros(ranges.distance_m.shape, dtype=bool)
    for corner_x in (0.0, room.room_x_m):
        for corner_y in (0.0, room.room_y_m):
            off_x, off_y = corner_x - ranges.hit_x_m, corner_y - ranges.hit_y_m
            near |= np.hypot(off_x, off_y) < within_m
            to_x, to_y = off_x + ranges.distance_m * c, off_y + ranges.distance_m * s
            near |= np.abs(np.arctan2(c * to_y - s * to_x, c * to_x + s * to_y)) < within_rad
    return near

"""Rays in an empty rectangular room 0 <= x <= size_x, 0 <= y <= size_y (m)."""

from collections.abc import Sequence

import numpy as np

from benchmarks.diagnosis.independent_cases.recipes import Array

Ray = tuple[Array, Array, Array]  # start x [m], y [m] and heading [rad]


def cast(ray: Ray, room: Sequence[float]) -> tuple[Array, Array]:
    """Return the distance (m) from a point inside to a wall, and the wall: 0 x=0, 1 x=max, 2 y=0, 3 y=max."""
    x, y, heading = ray
    size_x, size_y = room
    c, s = np.cos(heading), np.sin(heading)
    with np.errstate(divide="ignore", invalid="ignore"):
        along_x = np.where(c > 0, (size_x - x) / c, np.where(c < 0, -x / c, np.inf))
        along_y = np.where(s > 0, (size_y - y) / s, np.where(s < 0, -y / s, np.inf))
    wall = np.where(along_x <= along_y, np.where(c > 0, 1, 0), np.where(s > 0, 3, 2))
    return np.minimum(along_x, along_y), wall


def corner_distance(ray: Ray, room: Sequence[float]) -> Array:
    """Return the distance (m) between the point that the ray hits and the nearest corner of the room."""
    x, y, heading = ray
    d, _ = cast(ray, room)
    px, py = x + d * np.cos(heading), y + d * np.sin(heading)
    return np.hypot(np.minimum(px, room[0] - px), np.minimum(py, room[1] - py))


def sensor_ray(pose: Array, mount: Sequence[float]) -> Ray:
    """Return the ray of a sensor; pose (..., 3) is x [m], y [m], yaw [rad], mount the same in the axle frame."""
    c, s = np.cos(pose[..., 2]), np.sin(pose[..., 2])
    x = pose[..., 0] + mount[0] * c - mount[1] * s
    y = pose[..., 1] + mount[0] * s + mount[1] * c
    return x, y, pose[..., 2] + mount[2]

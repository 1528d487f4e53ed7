"""What range sensors of a robot see of the walls of an empty room."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from .case import Array, World

CORNER_M = 0.02
CORNER_RAD = 0.05
SENSORS = ("front", "left", "right")


def walls(nominal: Mapping, world: World) -> Array:
    """x of the near and far wall, then y: (4,) in the room as it is."""
    moved = world.beyond("moved_wall", "moved_m")
    return np.array([0.0, nominal["world"]["room_x_m"] + moved, 0.0, nominal["world"]["room_y_m"]])


def cast(origin: Array, heading: Array, room: Array) -> tuple[Array, Array]:
    """Distance along rays (...) to the first wall, and its number 0 to 3; from inside the room."""
    way = np.stack([np.cos(heading), np.cos(heading), np.sin(heading), np.sin(heading)], axis=-1)
    away = room - np.repeat(origin, 2, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        distances = np.where(np.abs(way) > 1e-12, away / way, np.inf)
    distances = np.where(distances > 0.0, distances, np.inf)
    first = np.argmin(distances, axis=-1)
    distance = np.take_along_axis(distances, first[..., None], axis=-1)[..., 0]
    return np.where(np.isfinite(distance), distance, np.nan), first


def rays(nominal: Mapping, world: World, pose: Array, sensor: str) -> tuple[Array, Array]:
    """Origins (..., 2) and headings (...) of a sensor at poses (..., 3) of the axle's middle."""
    mount = nominal["tof"]["mount"][sensor]
    x, y, theta = pose[..., 0], pose[..., 1], pose[..., 2]
    cos, sin = np.cos(theta), np.sin(theta)
    origin = [x + cos * mount["x_m"] - sin * mount["y_m"], y + sin * mount["x_m"] + cos * mount["y_m"]]
    heading = theta + mount["yaw_rad"] + world.value("tof_mount_yaw", "angle_rad", 0.0, sensor)
    return np.stack(origin, axis=-1), heading


def ranges(nominal: Mapping, world: World, pose: Array, sensor: str) -> Array:
    """Readings (...) without noise, however far."""
    origin, heading = rays(nominal, world, pose, sensor)
    distance, wall = cast(origin, heading, walls(nominal, world))
    through = world.beyond("glass_wall", "share")
    if through:
        distance = np.where(wall == world.beyond("glass_wall", "wall"), (1.0 + through) * distance, distance)
    offset = world.own["range_offset_m"] + world.value("tof_range_offset", "offset_m", 0.0, sensor)
    return world.value("tof_range_scale", "scale", 1.0) * distance + offset


def clear_of_corners(nominal: Mapping, world: World, pose: Array, sensor: str) -> NDArray[np.bool_]:
    """Whether a slightly different ray (...) would hit the same wall."""
    origin, heading = rays(nominal, world, pose, sensor)
    room = walls(nominal, world)
    distance, wall = cast(origin, heading, room)
    same = np.ones(wall.shape, dtype=bool)
    for turn in (-CORNER_RAD, CORNER_RAD):
        same &= cast(origin, heading + turn, room)[1] == wall
    hit = origin + distance[..., None] * np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    x_gap = np.minimum(np.abs(hit[..., 0] - room[0]), np.abs(hit[..., 0] - room[1]))
    y_gap = np.minimum(np.abs(hit[..., 1] - room[2]), np.abs(hit[..., 1] - room[3]))
    return same & (np.maximum(x_gap, y_gap) > CORNER_M)

"""Distances along rays in a room with four walls."""

import numpy as np

from benchmarks.diagnosis.other_robots.draws import Array


def wall_distance(
    room: tuple[float, float], x: Array, y: Array, angle: Array, askew: float = 0.0
) -> tuple[Array, Array]:
    """Return the distance to the nearest wall along a ray, and the angle to the normal of that wall."""
    c, s = np.cos(angle), np.sin(angle)
    with np.errstate(divide="ignore", invalid="ignore"):
        east = (room[0] + askew * (y - room[1] / 2) - x) / (c - askew * s)
        candidates = np.array(
            [
                np.where(east > 0, east, np.inf),
                np.where(c < 0, -x / c, np.inf),
                np.where(s > 0, (room[1] - y) / s, np.inf),
                np.where(s < 0, -y / s, np.inf),
            ]
        )
    candidates = np.where(candidates > 0, candidates, np.inf)
    which = np.argmin(candidates, axis=0)
    d = np.take_along_axis(candidates, which[None], axis=0)[0]
    cosine = np.where(which < 2, np.abs(c), np.abs(s))
    return d, np.arccos(np.clip(cosine, 0, 1))


def box_distance(box: tuple[float, float, float, float], x: Array, y: Array, angle: Array) -> Array:
    """Return the distance to a box (x0, y0, x1, y1) along a ray, infinite where the ray misses it."""
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (box[0] - x) / np.cos(angle), (box[2] - x) / np.cos(angle)
        c, d = (box[1] - y) / np.sin(angle), (box[3] - y) / np.sin(angle)
    near = np.maximum(np.minimum(a, b), np.minimum(c, d))
    far = np.minimum(np.maximum(a, b), np.maximum(c, d))
    return np.where((near < far) & (near > 0), near, np.inf)


def mounted(mount: tuple[float, float, float], pose: Array) -> tuple[Array, Array]:
    """Return the positions of a sensor on robots at some poses (rows of x, y, heading)."""
    c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    return pose[:, 0] + mount[0] * c - mount[1] * s, pose[:, 1] + mount[0] * s + mount[1] * c

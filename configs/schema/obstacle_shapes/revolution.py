"""Bodies of triangles that are round about the vertical axis."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from symolo.arena.mesh import TriangleMesh

SIDES = 64
"""Sides of a round body. Their middles are nearer to the axis than their corners by 0.12 % of the radius."""


def solid_of_revolution(profile: Sequence[tuple[float, float]]) -> TriangleMesh:
    """Return the closed body between a profile and the vertical axis.

    Args:
        profile: Radius [m] and height [m] of each corner, from the lower end to the upper one; both are on the axis.
    """
    angle = 2.0 * np.pi * np.arange(SIDES) / SIDES
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros(SIDES)], axis=1)
    vertices, rings, count = [], [], 0
    for radius_m, height_m in profile:
        corners = radius_m * circle[: SIDES if radius_m else 1] + (0.0, 0.0, height_m)
        rings.append(np.resize(np.arange(count, count + len(corners)), SIDES))
        vertices.append(corners)
        count += len(corners)
    triangles = []
    for lower, upper in pairwise(rings):
        left_of_lower, left_of_upper = np.roll(lower, -1), np.roll(upper, -1)
        triangles += [np.stack([lower, left_of_lower, left_of_upper], axis=1)]
        triangles += [np.stack([lower, left_of_upper, upper], axis=1)]
    corners = np.concatenate(triangles)
    has_area = (corners != np.roll(corners, 1, axis=1)).all(axis=1)  # the others have two corners on the axis
    return TriangleMesh(np.concatenate(vertices), corners[has_area])

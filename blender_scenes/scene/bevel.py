"""Boxes with bevelled edges, because every edge of a real box reflects some light."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from blender_scenes.scene.description import Mesh, Point2
from symolo.core.arrays import Array

BEVEL_M = 0.0008

Face = tuple[Array, Sequence[Point2], str]
"""Corners (N, 3) counter-clockwise seen from outside, their surface coordinates [m], and the surface."""


def bevelled_box(name: str, corners: Array, sides: Sequence[str], lid: str, bevel_m: float = BEVEL_M) -> Mesh:
    """Return a box whose upright and upper edges are bevelled at 45 degrees; it is open below.

    Args:
        name: Name of the mesh.
        corners: (8, 3) as `geometry.box_corners` returns them; the mesh lies within them.
        sides: Surface of each of the first four of `geometry.SIDES`; a side's bevels have the same surface.
        lid: Surface of the top.
        bevel_m: Width of the bevel on both faces; at most a fifth of the box's shortest side.
    """
    foot, up = corners[:4], corners[4] - corners[0]
    along = np.roll(foot, -1, axis=0) - foot
    height, length = float(np.linalg.norm(up)), np.linalg.norm(along, axis=1)
    cut = min(bevel_m, 0.2 * min(height, *length.tolist()))
    up, along = up / height, along / length[:, None]
    faces: list[Face] = []
    for i, surface in zip((3, 0, 1, 2), sides, strict=True):
        j = (i + 1) % 4
        faces += _side(foot[i], foot[j], (along[i], along[j], up), (float(length[i]), height, cut), surface)
    inset = np.array([foot[i] + cut * (along[i] - along[i - 1]) + height * up for i in range(4)])
    width, depth = float(length[0]), float(length[1])
    lid_uv = ((cut, cut), (width - cut, cut), (width - cut, depth - cut), (cut, depth - cut))
    return _assembled(name, [*faces, (inset, lid_uv, lid)])


def _side(
    begin: Array, end: Array, axes: tuple[Array, Array, Array], size: tuple[float, float, float], surface: str
) -> list[Face]:
    """Return the face of a side, its edge to the next side, its upper edge, and the corner where these meet.

    `axes` are the unit vectors along the side, inwards (along the next side) and up; `size` is length, height and cut.
    """
    (along, inwards, up), (length, height, cut) = axes, size
    a, b, c = begin + cut * along, end - cut * along, end + cut * inwards
    shoulder, top = (height - cut) * up, height * up + cut * inwards
    slope = 2.0**0.5 * cut
    u0, u1, u2, v1, v2 = cut, length - cut, length - cut + slope, height - cut, height - cut + slope
    tip = u1 + 0.5 * slope, v1 + 0.75**0.5 * slope
    return [
        (np.array([a, b, b + shoulder, a + shoulder]), ((u0, 0.0), (u1, 0.0), (u1, v1), (u0, v1)), surface),
        (np.array([b, c, c + shoulder, b + shoulder]), ((u1, 0.0), (u2, 0.0), (u2, v1), (u1, v1)), surface),
        (np.array([a + shoulder, b + shoulder, b + top, a + top]), ((u0, v1), (u1, v1), (u1, v2), (u0, v2)), surface),
        (np.array([b + shoulder, c + shoulder, b + top]), ((u1, v1), (u2, v1), tip), surface),
    ]


def _assembled(name: str, faces: Sequence[Face]) -> Mesh:
    """Return a mesh whose faces share no vertices, so that each is shaded flat."""
    vertices = [(float(x), float(y), float(z)) for places, _, _ in faces for x, y, z in places]
    first = np.cumsum([0, *(len(places) for places, _, _ in faces)]).tolist()
    polygons = tuple(tuple(range(start, stop)) for start, stop in pairwise(first))
    uv = tuple(tuple(face_uv) for _, face_uv, _ in faces)
    return Mesh(name, tuple(vertices), polygons, uv, tuple(surface for _, _, surface in faces))

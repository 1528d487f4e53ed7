"""Occlusion of points by the scene's triangles, in closed form."""

import numpy as np
from numpy.typing import NDArray

from blender_scenes.scene.description import Mesh
from symolo.core.arrays import Array

_MARGIN = 1e-6
"""Share of the distance, just before the point, that does not count: the point is a corner of a body there."""
_AT_A_TIME = 500_000
"""Number of pairs of a ray and a triangle that are tested at once."""


def triangles(mesh: Mesh) -> Array:
    """Return the convex faces of a mesh as triangles (T, 3, 3)."""
    fans = [(face[0], face[k], face[k + 1]) for face in mesh.faces for k in range(1, len(face) - 1)]
    return np.array(mesh.vertices)[np.array(fans, dtype=int).reshape(-1, 3)]


def hidden(points: Array, screens: Array) -> NDArray[np.bool_]:
    """Return (N,) whether one of the triangles (T, 3, 3) is between the camera and each of the points (N, 3), all in C.

    The ray test is that of Moeller and Trumbore (Fast, minimum storage
    ray/triangle intersection, 1997), for both sides of a triangle.
    """
    if not len(points):
        return np.empty(0, dtype=bool)
    near = _reached(points, screens)
    block = max(1, _AT_A_TIME // max(1, len(near)))
    return np.concatenate([_hidden(points[first : first + block], near) for first in range(0, len(points), block)])


def _reached(points: Array, screens: Array) -> Array:
    """Return the triangles that reach into the pyramid around all points; no other triangle can hide a point.

    If a point is beside the camera or behind it, as with a fisheye lens, there is no such pyramid.
    """
    if np.any(points[:, 2] <= 0):
        return screens
    slopes = points[:, :2] / points[:, 2:]
    along, depth = screens[..., :2], screens[..., 2:]
    beside = np.all(along < slopes.min(axis=0) * depth, axis=1) | np.all(along > slopes.max(axis=0) * depth, axis=1)
    return screens[~(beside.any(axis=1) | np.all(depth[..., 0] <= 0, axis=1))]


def _hidden(points: Array, screens: Array) -> NDArray[np.bool_]:
    edge1, edge2 = screens[:, 1] - screens[:, 0], screens[:, 2] - screens[:, 0]
    across = np.cross(points[:, None, :], edge2)
    volume = np.einsum("tk,ntk->nt", edge1, across)
    turned = np.cross(edge1, screens[:, 0])
    with np.errstate(divide="ignore", invalid="ignore"):  # a ray in a triangle's plane passes it
        u = -np.einsum("tk,ntk->nt", screens[:, 0], across) / volume
        v = points @ turned.T / volume
        share = np.einsum("tk,tk->t", edge2, turned) / volume
        return np.any((u >= 0) & (v >= 0) & (u + v <= 1) & (share > 0) & (share < 1 - _MARGIN), axis=1)

"""The interior of bodies of triangles, by the generalised winding number.

It is 1 inside a closed surface and 0 outside, and changes little if the surface has small holes or parts that overlap
(Jacobson, Kavan and Sorkine-Hornung, Robust inside-outside segmentation using generalized winding numbers, 2013). The
solid angle of a triangle is that of Van Oosterom and Strackee, The solid angle of a plane triangle, 1983.
"""

import numpy as np
from numpy.typing import NDArray

from symolo.arena.mesh import TriangleMesh
from symolo.core.arrays import Array

MIN_WINDING = 0.5
"""Winding number from which on a place is inside."""
_CHUNK = 200_000
"""Pairs of a place and a triangle that are examined at once."""


def contains(mesh: TriangleMesh, places: Array) -> NDArray[np.bool_]:
    """Return which places (N, 3) [m] in the frame of the body are inside it."""
    corners = mesh.vertices[mesh.triangles]
    step = max(1, _CHUNK // len(corners))
    numbers = [_winding_numbers(corners, places[begin : begin + step]) for begin in range(0, len(places), step)]
    return np.abs(np.concatenate([*numbers, np.zeros(0)])) > MIN_WINDING


def _winding_numbers(corners: Array, places: Array) -> Array:
    """Return (N,) for triangles (M, 3, 3) and places (N, 3)."""
    a, b, c = (corners[None, :, corner] - places[:, None] for corner in range(3))
    a_m, b_m, c_m = (np.linalg.norm(edge, axis=-1) for edge in (a, b, c))
    ab, bc, ca = (np.einsum("nmk,nmk->nm", *pair) for pair in ((a, b), (b, c), (c, a)))
    volume = np.einsum("nmk,nmk->nm", a, np.cross(b, c))
    half_angle = np.arctan2(volume, a_m * b_m * c_m + ab * c_m + bc * a_m + ca * b_m)
    return half_angle.sum(axis=1) / (2.0 * np.pi)

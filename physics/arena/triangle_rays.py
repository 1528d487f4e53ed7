"""Rays against bodies of triangles (Moeller and Trumbore, Fast, Minimum Storage Ray/Triangle Intersection, 1997).

A body's bounding box is tested first, so that few rays meet its triangles.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array

_PARALLEL = 1e-15
_BLOCK = 2_000_000
"""Largest number of pairs of a ray and a triangle that are computed at once, to limit memory."""


@dataclass(frozen=True)
class TriangleBody:
    """Triangles in the frame in which rays are given."""

    corner: Array
    """(T, 3), first corner of each triangle."""
    edges: Array
    """(2, T, 3), from the first corner to the others."""
    normal: Array
    """(T, 3), of unit length."""

    @classmethod
    def from_corners(cls, corners: Array) -> "TriangleBody":
        """Return the body with these triangles (T, 3, 3)."""
        edges = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]])
        cross = np.cross(edges[0], edges[1])
        length = np.maximum(np.linalg.norm(cross, axis=1, keepdims=True), 1e-30)
        return cls(corners[:, 0], edges, cross / length)

    def cast(self, origins: Array, along: Array) -> tuple[Array, Array]:
        """Return the fraction of each ray up to the body, infinite without a hit, and the normal there.

        Args:
            origins: (N, 3), beginnings of the rays.
            along: (N, 3), from the beginnings to the ends.
        """
        fraction = np.full(len(origins), np.inf)
        triangle = np.zeros(len(origins), np.int64)
        rays = max(1, _BLOCK // max(1, len(self.corner)))
        for first in range(0, len(origins), rays):
            some = slice(first, first + rays)
            hits = self._fractions(origins[some], along[some])
            triangle[some] = hits.argmin(axis=1)
            fraction[some] = hits[np.arange(len(hits)), triangle[some]]
        normal = self.normal[triangle]
        # Files are not always closed or oriented: a face has two sides, and the normal is that of the side that is met.
        behind = np.einsum("nk,nk->n", normal, along) > 0.0
        return fraction, np.where(behind[:, None], -normal, normal)

    def _fractions(self, origins: Array, along: Array) -> Array:
        """Return (N, T): the fraction of each ray at which it meets each triangle, infinite where it does not."""
        one, two = self.edges
        p = np.cross(along[:, None], two[None])
        determinant = np.einsum("tk,ntk->nt", one, p)
        with np.errstate(divide="ignore", invalid="ignore"):
            inverse = 1.0 / determinant
            from_corner = origins[:, None] - self.corner[None]
            u = np.einsum("ntk,ntk->nt", from_corner, p) * inverse
            q = np.cross(from_corner, one[None])
            v = np.einsum("nk,ntk->nt", along, q) * inverse
            fraction = np.einsum("tk,ntk->nt", two, q) * inverse
            hit = (np.abs(determinant) > _PARALLEL) & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (fraction >= 0.0)
        return np.where(hit, fraction, np.inf)


def in_box(half_size: Array, origins: Array, along: Array) -> NDArray[np.bool_]:
    """Return which rays (N,) touch a box about the origin, or begin in it."""
    with np.errstate(divide="ignore", invalid="ignore"):
        near, far = (-half_size - origins) / along, (half_size - origins) / along
    enter, leave = np.fmin(near, far).max(axis=1), np.fmax(near, far).min(axis=1)
    return np.asarray((enter <= leave) & (leave >= 0.0) & (enter <= 1.0))

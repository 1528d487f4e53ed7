"""Ray casts against floor, walls and obstacles in closed form.

The robot is not part of the scene and cannot be hit. PyBullet's ray test approaches surfaces in steps: on these boxes
it is wrong by up to 3 mm, and its normals by tens of degrees near edges, at three times the cost.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physics.arena.triangle_rays import TriangleBody, in_box
from symolo.arena.geometry import Arena, Box
from symolo.arena.mesh import TriangleMesh
from symolo.core.arrays import Array

PARALLEL = 1e-30
"""Added to every direction [m], so that a ray along a face does not divide by zero; negligible otherwise."""
FLOOR_SIZE_M = (1e6, 1e6, 1.0)
"""Size of the floor, which is a box like the others, in row 0, with its top at height 0."""


@dataclass(frozen=True)
class RayHits:
    """The first surface that each ray meets."""

    fraction: Array
    """(N,), fraction of the distance from origin to end; 1 without a hit."""
    surface: NDArray[np.int64]
    """(N,), -1 for no hit, 0 for the floor, 1 + i for box i of the arena."""
    normal: Array
    """(N, 3), unit normal of the surface in W; zero without a hit."""


class RayScene:
    """The boxes at one time; a cast at another time moves those that have a path."""

    def __init__(self, arena: Arena) -> None:
        self._moving = [(1 + index, box) for index, box in enumerate(arena.boxes) if box.motion is not None]
        self._yaw = np.array([0.0, *(box.yaw_rad for box in arena.boxes)])
        self._middle = np.array([(0.0, 0.0, -0.5 * FLOOR_SIZE_M[2]), *(box.center for box in arena.boxes)])
        self._half_size = 0.5 * np.array([FLOOR_SIZE_M, *(box.size for box in arena.boxes)]).T[..., None]
        self._bodies = [
            (1 + index, 0.5 * np.array(box.size), _triangles_of(box, box.mesh))
            for index, box in enumerate(arena.boxes)
            if box.is_solid and box.mesh is not None
        ]
        """Row, half the size and triangles of each obstacle that is no box."""
        for index, box in enumerate(arena.boxes):
            if box.mesh is not None or not box.is_solid:
                self._half_size[:, 1 + index] = -1.0  # no ray is between faces in the wrong order
        self._time_s = 0.0
        self._orient()

    def _orient(self) -> None:
        yaw = self._yaw
        c, s, zero, one = np.cos(yaw), np.sin(yaw), np.zeros_like(yaw), np.ones_like(yaw)
        # (3, B, 3): the x, y and z axes of all boxes, in W.
        axes = np.stack([np.stack(axis, axis=-1) for axis in ([c, s, zero], [-s, c, zero], [zero, zero, one])])
        self._to_boxes = axes.reshape(-1, 3)
        self._center = np.einsum("abk,bk->ab", axes, self._middle)[..., None]
        # (2, 3, B, 3): normals of the faces that rays along +axis meet, and of those that rays along -axis meet.
        self._outward = np.stack([-axes, axes])

    def _move(self, time_s: float) -> None:
        for row, box in self._moving:
            x, y, self._yaw[row] = box.poses_at(np.array([time_s]))[0]
            self._middle[row, :2] = x, y
        self._time_s = time_s
        self._orient()

    def cast(self, origins: Array, ends: Array, time_s: float = 0.0) -> RayHits:
        """Cast rays from `origins` to `ends`, (N, 3) each, in W. A ray that starts inside a box does not meet it.

        Args:
            origins: Beginnings of the rays.
            ends: Ends of the rays.
            time_s: Time since the start of the run, at which moving obstacles are placed.
        """
        if self._moving and time_s != self._time_s:
            self._move(time_s)
        shape = (*self._center.shape[:2], len(origins))
        along = (self._to_boxes @ (ends - origins).T).reshape(shape)
        along += PARALLEL
        # Slab method: the range of fractions in which each ray is within each pair of faces.
        per_metre = 1.0 / along
        middle = (self._center - (self._to_boxes @ origins.T).reshape(shape)) * per_metre
        half = self._half_size * np.abs(per_metre)
        entry, leave = middle - half, middle + half
        # A ray is inside a box after its last entry into a pair of faces and before its first exit from one.
        enters = np.maximum.reduce(entry)
        np.putmask(enters, (enters > np.minimum.reduce(leave)) | (enters < 0.0), np.inf)
        fraction = np.minimum.reduce(enters)
        surface, ray = enters.argmin(axis=0), np.arange(len(origins))
        # The face of the last entry is the one that the ray meets.
        axis = entry[:, surface, ray].argmax(axis=0)
        normal = self._outward[(along[axis, surface, ray] < 0.0).astype(np.int64), axis, surface]
        for row, half_size, body in self._bodies:
            to_body = self._to_boxes.reshape(3, -1, 3)[:, row]
            start, to_end = (origins - self._middle[row]) @ to_body.T, (ends - origins) @ to_body.T
            (near,) = in_box(half_size, start, to_end + PARALLEL).nonzero()
            if len(near):
                met, normals = body.cast(start[near], to_end[near])
                closer = met < fraction[near]
                rays = near[closer]
                fraction[rays], surface[rays], normal[rays] = met[closer], row, normals[closer] @ to_body
        (nothing,) = (fraction > 1.0).nonzero()
        fraction[nothing], surface[nothing], normal[nothing] = 1.0, -1, 0.0
        return RayHits(fraction, surface, normal)


def _triangles_of(box: Box, mesh: TriangleMesh) -> TriangleBody:
    """Return the triangles of an obstacle in its own axes about the middle of its bounding box."""
    return TriangleBody.from_corners((mesh.vertices - (0.0, 0.0, 0.5 * box.size[2]))[mesh.triangles])

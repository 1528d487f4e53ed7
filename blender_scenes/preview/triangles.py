"""Meshes as arrays of triangles."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from blender_scenes.scene.description import Mesh
from symolo.core.arrays import Array


@dataclass(frozen=True)
class Triangles:
    """T triangles, each with the surface that it shows."""

    corners: Array
    """(T, 3, 3), x, y, z [m] of each corner."""
    uv_m: Array
    """(T, 3, 2), surface coordinates of each corner [m]."""
    surface: NDArray[np.intp]
    """(T,), number of the surface."""

    @classmethod
    def from_meshes(cls, meshes: Sequence[Mesh], numbers: Mapping[str, int]) -> "Triangles":
        """Return all faces as fans of triangles about their first corner, in the meshes' order.

        Args:
            meshes: Meshes in one frame.
            numbers: Numbers of the surfaces by their names.

        Raises:
            ValueError: A face is not convex, so that its fan would cover more than the face.
        """
        parts = [_cut(mesh, numbers) for mesh in meshes]
        return cls.joined(parts) if parts else cls(np.zeros((0, 3, 3)), np.zeros((0, 3, 2)), np.zeros(0, np.intp))

    @classmethod
    def joined(cls, parts: Sequence["Triangles"]) -> "Triangles":
        return cls(
            np.concatenate([part.corners for part in parts]),
            np.concatenate([part.uv_m for part in parts]),
            np.concatenate([part.surface for part in parts]),
        )

    def placed(self, X: Array) -> "Triangles":
        """Return the triangles moved by the pose X (4, 4) of their frame."""
        return replace(self, corners=self.corners @ X[:3, :3].T + X[:3, 3])

    @property
    def crosses(self) -> Array:
        """(T, 3), normals whose length is twice the area [m2], outward for counter-clockwise corners."""
        a, b, c = self.corners[:, 0], self.corners[:, 1], self.corners[:, 2]
        return np.cross(b - a, c - a)

    @property
    def normals(self) -> Array:
        """(T, 3), of unit length; 0 where a triangle has no area."""
        crosses = self.crosses
        return crosses / np.maximum(np.linalg.norm(crosses, axis=1, keepdims=True), 1e-30)


def _cut(mesh: Mesh, numbers: Mapping[str, int]) -> Triangles:
    """Return the fans of a mesh."""
    faces = [(face, (0, i, i + 1)) for face, points in enumerate(mesh.faces) for i in range(1, len(points) - 1)]
    vertices = np.array(mesh.vertices)
    corners = vertices[[[mesh.faces[face][i] for i in fan] for face, fan in faces]]
    uv_m = np.array([[mesh.uv_m[face][i] for i in fan] for face, fan in faces])
    face_of = np.array([face for face, _ in faces])
    cut = Triangles(corners, uv_m, np.array([numbers[mesh.face_surface[face]] for face in face_of], np.intp))
    _require_fans(mesh, cut.crosses, face_of)
    return cut


def _require_fans(mesh: Mesh, crosses: Array, face_of: NDArray[np.intp]) -> None:
    whole = np.zeros((len(mesh.faces), 3))
    np.add.at(whole, face_of, crosses)
    area2 = np.linalg.norm(whole, axis=1)
    against = np.einsum("ij,ij->i", crosses, whole[face_of]) < -1e-9 * area2[face_of] ** 2
    if against.any():
        raise ValueError(f"mesh {mesh.name}: face {face_of[against][0]} is not convex; cut it into faces that are")

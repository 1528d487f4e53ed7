"""The bodies that throw shadows on the floor, in the shapes that are drawn for them."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from blender_scenes.scene.description import Mesh, Scene
from symolo.core.arrays import Array

_FLAT = 1e-6
"""Distance of a corner beyond the plane of a face [m] up to which it counts as in the plane."""


def casting_meshes(scene: Scene) -> tuple[tuple[Mesh, ...], tuple[Mesh, ...]]:
    """Return the meshes of the robot and those of moving obstacles; glass throws hardly any shadow and has no faces."""
    clear = {surface.name for surface in scene.surfaces if surface.transmission}
    moving = (
        Mesh(mesh.name, mesh.vertices, (), (), ()) if clear & set(mesh.face_surface) else mesh for mesh in scene.moving
    )
    return scene.robot_parts, tuple(moving)


@dataclass(frozen=True)
class Caster:
    """A convex body, or a face of a mesh that is not convex."""

    corners: Array
    """(K, 3)."""
    is_body: bool
    """Whether its shadow is the convex hull of the shadows of its corners, and not a polygon with these corners."""


def casters(meshes: Sequence[Mesh]) -> list[Caster]:
    """Return what to draw for the shadow of some meshes: each convex one as a whole, which takes less time."""
    shapes: list[Caster] = []
    for mesh in meshes:
        vertices = np.array(mesh.vertices, float)
        if _is_convex(mesh, vertices):
            shapes.append(Caster(vertices[sorted({corner for face in mesh.faces for corner in face})], is_body=True))
        else:
            shapes += [Caster(vertices[list(face)], is_body=False) for face in mesh.faces]
    return shapes


def _is_convex(mesh: Mesh, vertices: Array) -> bool:
    """Return whether the faces close a body that lies behind the plane of each of them."""
    edges = {edge for face in mesh.faces for edge in pairwise([*face, face[0]])}
    if not edges or any((end, begin) not in edges for begin, end in edges):
        return False
    corners = vertices[sorted({corner for edge in edges for corner in edge})]
    for face in mesh.faces:
        around = vertices[list(face)]
        normal = np.cross(around, np.roll(around, -1, axis=0)).sum(axis=0)
        if ((corners - around[0]) @ normal).max() > _FLAT * np.linalg.norm(normal):
            return False
    return True

"""Meshes of the arena's boxes and of simple bodies; each face has surface coordinates in metres."""

from collections.abc import Sequence

import numpy as np

from blender_scenes.scene.description import Mesh, Point2, Point3
from symolo.arena.geometry import Box
from symolo.arena.mesh import TriangleMesh
from symolo.core.arrays import Array

SIDES = ("back", "right", "front", "left", "bottom", "top")
"""Faces of a box: -x', -y', +x', +y', -z', +z' in its own axes."""

_BOX_FACES = ((3, 0, 4, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 2, 1, 0), (4, 5, 6, 7))


def rectangle(name: str, corners: Sequence[Point3], surface: str) -> Mesh:
    """Return a rectangle; u runs along the first edge, v towards the last corner."""
    points = np.asarray(corners)
    width, height = np.linalg.norm(points[1] - points[0]), np.linalg.norm(points[3] - points[0])
    uv = ((0.0, 0.0), (float(width), 0.0), (float(width), float(height)), (0.0, float(height)))
    return Mesh(name, tuple(corners), ((0, 1, 2, 3),), (uv,), (surface,))


def floor(name: str, low: Point2, high: Point2, yaw_rad: float, surface: str) -> Mesh:
    """Return the floor from `low` to `high`, its pattern turned by `yaw_rad` about the origin of W."""
    corners = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]
    c, s = float(np.cos(yaw_rad)), float(np.sin(yaw_rad))
    uv = tuple((c * x + s * y, c * y - s * x) for x, y in corners)
    return Mesh(name, tuple((x, y, 0.0) for x, y in corners), ((0, 1, 2, 3),), (uv,), (surface,))


def box_corners(box: Box) -> Array:
    """Return the corners (8, 3), the lower four first, counter-clockwise."""
    footprint = box.footprint()
    low, high = box.center[2] - 0.5 * box.size[2], box.center[2] + 0.5 * box.size[2]
    return np.concatenate(
        [np.column_stack([footprint, np.full(4, low)]), np.column_stack([footprint, np.full(4, high)])]
    )


def box(name: str, corners: Array, surfaces: Sequence[str | None]) -> Mesh:
    """Return a box from its eight corners and a surface for each of `SIDES`; a side with None is open."""
    faces = [face for face, surface in zip(_BOX_FACES, surfaces, strict=True) if surface is not None]
    uv = []
    for face in faces:
        p = corners[list(face)]
        width, height = float(np.linalg.norm(p[1] - p[0])), float(np.linalg.norm(p[3] - p[0]))
        uv.append(((0.0, 0.0), (width, 0.0), (width, height), (0.0, height)))
    vertices = tuple((float(x), float(y), float(z)) for x, y, z in corners)
    return Mesh(name, vertices, tuple(faces), tuple(uv), tuple(s for s in surfaces if s is not None))


def block(name: str, center: Point3, size: Point3, surface: str) -> Mesh:
    """Return a box along the axes of its frame."""
    half = 0.5 * np.asarray(size)
    signs = np.array(
        [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]
    )
    return box(name, np.asarray(center) + signs * half, (surface,) * 6)


def triangle_body(name: str, box: Box, body: TriangleMesh, surface: str) -> Mesh:
    """Return an obstacle of triangles at its place."""
    c, s = float(np.cos(box.yaw_rad)), float(np.sin(box.yaw_rad))
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return mesh_of_triangles(name, body, turn, (*box.center[:2], box.center[2] - 0.5 * box.size[2]), surface)


def mesh_of_triangles(name: str, body: TriangleMesh, turn: Array, base: Point3, surface: str) -> Mesh:
    """Return triangles, turned by `turn` (3, 3) and moved to `base`; u and v lie along the flattest axes of a face."""
    corners = body.vertices[body.triangles]
    steepest = np.abs(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])).argmax(axis=1)
    flat = np.array([(1, 2), (0, 2), (0, 1)])[steepest]
    uv_m = np.take_along_axis(corners, np.broadcast_to(flat[:, None], (len(corners), 3, 2)), axis=2)
    return Mesh(
        name,
        tuple((x, y, z) for x, y, z in (body.vertices @ turn.T + base).tolist()),
        tuple((i, j, k) for i, j, k in body.triangles.tolist()),
        tuple(tuple((u, v) for u, v in face) for face in uv_m.tolist()),
        (surface,) * len(body.triangles),
    )


def wheel(name: str, center: Point3, radius_m: float, width_m: float, surface: str) -> Mesh:
    """Return a closed cylinder of 48 sides about its frame's y axis."""
    sides = 48
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.zeros((sides, 3))
    ring[:, 2], ring[:, 0] = radius_m * np.cos(angle), radius_m * np.sin(angle)
    shift = np.array([0.0, 0.5 * width_m, 0.0])
    vertices = np.asarray(center) + np.concatenate([ring - shift, ring + shift])
    faces = [tuple(range(sides - 1, -1, -1)), tuple(range(sides, 2 * sides))]
    faces += [(i, (i + 1) % sides, sides + (i + 1) % sides, sides + i) for i in range(sides)]
    flat = [(float(radius_m * np.cos(a)), float(radius_m * np.sin(a))) for a in angle]
    arc = 2 * np.pi * radius_m / sides
    uv = [tuple(flat[::-1]), tuple(flat)]
    uv += [((i * arc, 0.0), ((i + 1) * arc, 0.0), ((i + 1) * arc, width_m), (i * arc, width_m)) for i in range(sides)]
    return Mesh(
        name,
        tuple((float(x), float(y), float(z)) for x, y, z in vertices),
        tuple(faces),
        tuple(uv),
        (surface,) * len(faces),
    )

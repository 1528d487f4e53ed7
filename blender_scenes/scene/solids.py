"""Bodies of furniture: turned, bent and padded ones, and several joined into one mesh."""

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

from blender_scenes.scene.description import Mesh, Point2, Point3
from symolo.core.arrays import Array
from symolo.core.geometry.poses import PlanarPose


def joined(name: str, parts: Iterable[Mesh]) -> Mesh:
    """Join several meshes into one; each face keeps its surface."""
    vertices: list[Point3] = []
    faces: list[tuple[int, ...]] = []
    uv: list[tuple[Point2, ...]] = []
    surfaces: list[str] = []
    for part in parts:
        first = len(vertices)
        vertices += part.vertices
        faces += [tuple(first + i for i in face) for face in part.faces]
        uv += part.uv_m
        surfaces += part.face_surface
    return Mesh(name, tuple(vertices), tuple(faces), tuple(uv), tuple(surfaces))


def moved(mesh: Mesh, by: Point3) -> Mesh:
    vertices = tuple((x + by[0], y + by[1], z + by[2]) for x, y, z in mesh.vertices)
    return Mesh(mesh.name, vertices, mesh.faces, mesh.uv_m, mesh.face_surface)


def stood(mesh: Mesh, pose: PlanarPose) -> Mesh:
    """Return the mesh with its frame at `pose` in W."""
    x, y, yaw = pose
    c, s = float(np.cos(yaw)), float(np.sin(yaw))
    vertices = tuple((x + c * a - s * b, y + s * a + c * b, z) for a, b, z in mesh.vertices)
    return Mesh(mesh.name, vertices, mesh.faces, mesh.uv_m, mesh.face_surface)


def posed(mesh: Mesh, axes: Array, at: Point3) -> Mesh:
    """Return the mesh with its axes along the columns of `axes` (3, 3) and its origin at `at`."""
    vertices = np.array(mesh.vertices) @ axes.T + at
    return Mesh(mesh.name, _points(vertices), mesh.faces, mesh.uv_m, mesh.face_surface)


def loft(name: str, rings: Sequence[Array], surface: str, *, closed: bool = True) -> Mesh:
    """Return a skin through rings of points (N, 3), counter-clockwise for somebody who looks back from the next ring.

    If it is `closed`, a flat face closes the first and the last ring.
    """
    sides, levels = len(rings[0]), len(rings)
    points = np.concatenate(rings)
    around, along = _lengths(rings)
    faces: list[tuple[int, ...]] = []
    uv: list[tuple[Point2, ...]] = []
    for level in range(levels - 1):
        low, high, v0, v1 = level * sides, (level + 1) * sides, along[level], along[level + 1]
        for i in range(sides):
            j, u0, u1 = (i + 1) % sides, around[i], around[i + 1]
            faces.append((low + i, low + j, high + j, high + i))
            uv.append(((u0, v0), (u1, v0), (u1, v1), (u0, v1)))
    for level, step in ((0, -1), (levels - 1, 1)) if closed else ():
        numbers = tuple(range(level * sides, (level + 1) * sides))[::step]
        faces.append(numbers)
        uv.append(_flat(points[list(numbers)]))
    return Mesh(name, _points(points), tuple(faces), tuple(uv), (surface,) * len(faces))


def _points(rows: Array) -> tuple[Point3, ...]:
    return tuple((x, y, z) for x, y, z in rows.tolist())


def lathe(name: str, profile: Sequence[Point2], surface: str, *, sides: int = 20, closed: bool = True) -> Mesh:
    """Return a body turned about z, from (radius, height) points that run upwards on its outside."""
    angle = 2 * np.pi * np.arange(sides) / sides
    rings = [np.column_stack([r * np.cos(angle), r * np.sin(angle), np.full(sides, z)]) for r, z in profile]
    return loft(name, rings, surface, closed=closed)


def rod(name: str, ends: tuple[Point3, Point3], radii_m: tuple[float, float], surface: str, *, sides: int = 12) -> Mesh:
    """Return a round bar or cone between two points."""
    return loft(name, _rings(np.array(ends), np.array(radii_m), sides), surface)


def pipe(name: str, path: Sequence[Point3], radius_m: float, surface: str, *, sides: int = 8) -> Mesh:
    """Return a round cable or tube along a path without sharp corners."""
    points = np.array(path)
    return loft(name, _rings(points, np.full(len(points), radius_m), sides), surface)


def cushion(name: str, center: Point3, size: Point3, surface: str, *, squareness: float = 4.0) -> Mesh:
    """Return a superellipsoid: an ellipsoid for a squareness of 2, closer to a rounded box for more."""
    power = 2.0 / squareness
    azimuth = 2 * np.pi * np.arange(20) / 20
    rings = []
    for latitude in np.linspace(-0.49 * np.pi, 0.49 * np.pi, 9):
        out, z = _power(np.cos(latitude), power), _power(np.sin(latitude), power)
        ring = np.stack([out * _power(np.cos(azimuth), power), out * _power(np.sin(azimuth), power)], axis=1)
        rings.append(np.asarray(center) + 0.5 * np.asarray(size) * np.column_stack([ring, np.full(20, z)]))
    return loft(name, rings, surface)


def _power(value: Array | float, exponent: float) -> Array:
    return np.sign(value) * np.abs(value) ** exponent


def _rings(points: Array, radii_m: Array, sides: int) -> list[Array]:
    """Return circles across a path, started at the axis that is farthest from all of its directions."""
    tangent = np.gradient(points, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    # One reference direction for all rings: they do not twist, and it is parallel to none of the tangents.
    reference = np.eye(3)[int(np.argmin(np.abs(tangent).max(axis=0)))]
    angle = 2 * np.pi * np.arange(sides) / sides
    rings = []
    for point, along, radius in zip(points, tangent, radii_m, strict=True):
        one = np.cross(along, reference)
        one /= np.linalg.norm(one)
        other = np.cross(along, one)
        rings.append(point + radius * (np.cos(angle)[:, None] * one + np.sin(angle)[:, None] * other))
    return rings


def _lengths(rings: Sequence[Array]) -> tuple[list[float], list[float]]:
    """Return the path lengths around the widest ring, at its corners, and along the skin, at each ring."""
    steps = [np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1) for ring in rings]
    widest = max(steps, key=lambda step: float(step.sum()))
    climbs = [float(np.linalg.norm(b - a, axis=1).mean()) for a, b in pairwise(rings)]
    return [0.0, *np.cumsum(widest).tolist()], [0.0, *np.cumsum(climbs).tolist()]


def _flat(points: Array) -> tuple[Point2, ...]:
    """Return the coordinates of a flat polygon in its plane, with the origin in its first corner."""
    normal = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    normal /= np.linalg.norm(normal)
    one = points[1] - points[0]
    one /= np.linalg.norm(one)
    plane = (points - points[0]) @ np.stack([one, np.cross(normal, one)], axis=1)
    return tuple((u, v) for u, v in plane.tolist())

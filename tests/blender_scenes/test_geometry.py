from dataclasses import replace

import numpy as np
import pytest

from blender_scenes import geometry
from blender_scenes.description import Mesh
from blender_scenes.scene import arena_bounds, describe
from configs.schema.look import LookConfig


def _normals_and_middles(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """By Newell's method, which holds for any planar polygon."""
    vertices = np.array(mesh.vertices)
    normals, middles = [], []
    for face in mesh.faces:
        p = vertices[list(face)]
        normals.append(np.cross(p, np.roll(p, -1, axis=0)).sum(axis=0))
        middles.append(p.mean(axis=0))
    return np.array(normals), np.array(middles)


def _by_name(scene, prefix: str) -> list[Mesh]:
    return [mesh for mesh in scene.meshes if mesh.name.startswith(prefix)]


@pytest.fixture(scope="module")
def scene(arena, robot):
    return describe(arena, robot, LookConfig(name="plain"), seed=1)


def test_the_tapes_have_the_edges_that_the_line_sensor_reads(arena, scene):
    tapes = _by_name(scene, "tape_")
    edges = arena.line.edges(spacing_m=0.004)
    assert len(tapes) == len(edges) == 6
    for mesh, (left, right) in zip(tapes, edges, strict=True):
        vertices = np.array(mesh.vertices)
        np.testing.assert_array_equal(vertices[:, :2], np.concatenate([right, left]))


def test_the_tapes_cover_what_the_line_covers(arena, scene):
    """Faces of the tapes against the sensor's own test of points, which knows nothing of meshes."""
    rng = np.random.default_rng(0)
    low, high = arena_bounds(arena)
    points = rng.uniform(low, high, (20000, 2))
    covered = np.zeros(len(points), dtype=bool)
    for mesh in _by_name(scene, "tape_"):
        vertices = np.array(mesh.vertices)[:, :2]
        for face in mesh.faces:
            a = vertices[list(face)]
            b = np.roll(a, -1, axis=0) - a
            delta = points[:, None] - a
            covered |= np.all(b[:, 0] * delta[..., 1] - b[:, 1] * delta[..., 0] >= 0, axis=1)
    reads = arena.line.covers(points)
    assert reads.sum() > 100
    assert np.count_nonzero(covered != reads) <= 2  # chords of 4 mm stand 8 um off the arcs


def test_the_tapes_lie_on_the_floor_and_face_up(scene):
    for mesh in _by_name(scene, "tape_"):
        assert 0 < min(v[2] for v in mesh.vertices) == max(v[2] for v in mesh.vertices) < 2e-4
        normals, _ = _normals_and_middles(mesh)
        assert np.all(normals[:, 2] > 0)


def test_each_box_stands_on_the_footprint_that_the_engine_collides_with(arena, scene):
    for box in arena.boxes:
        (mesh,) = _by_name(scene, f"{box.kind}_{box.name}")
        vertices = np.array(mesh.vertices)
        for z, corners in ((0.0, vertices[:4]), (box.size[2], vertices[4:])):
            np.testing.assert_allclose(corners, np.column_stack([box.footprint(), np.full(4, z)]), atol=1e-12)


def test_boxes_and_the_robot_face_outwards(scene, arena):
    solids = [m for box in arena.boxes for m in _by_name(scene, f"{box.kind}_{box.name}")] + list(scene.robot)
    for mesh in solids:
        normals, middles = _normals_and_middles(mesh)
        outward = np.sum(normals * (middles - np.array(mesh.vertices).mean(axis=0)), axis=1)
        assert np.all(outward > 0), mesh.name


def test_the_surface_coordinates_are_metres(scene):
    """Each edge of each flat face is as long on the surface as in space."""
    for mesh in (*scene.meshes, *scene.robot):
        vertices = np.array(mesh.vertices)
        for face, uv in zip(mesh.faces, mesh.uv_m, strict=True):
            p, q = vertices[list(face)], np.array(uv)
            space = np.linalg.norm(np.roll(p, -1, axis=0) - p, axis=1)
            surface = np.linalg.norm(np.roll(q, -1, axis=0) - q, axis=1)
            # Along an arc the tape's edges are longer or shorter than its middle; a wheel's tread is cut in chords.
            tolerance = 0.06 if mesh.name.startswith("tape") else 0.002
            np.testing.assert_allclose(surface, space, rtol=tolerance, err_msg=mesh.name)


def test_the_room_keeps_its_distance_from_the_arena(arena, scene):
    low, high = np.array(arena_bounds(arena))
    sides = [("east", 0, 1, high), ("north", 1, 1, high), ("west", 0, -1, low), ("south", 1, -1, low)]
    for side, axis, sign, bound in sides:
        walls = np.concatenate([np.array(m.vertices) for m in _by_name(scene, f"{side}_wall")])
        assert np.min(sign * (walls[:, axis] - bound[axis])) >= 1.3


def test_an_empty_arena_has_bounds_too(arena):
    empty = replace(arena, line=replace(arena.line, pieces=()), boxes=())
    assert arena_bounds(empty) == ((-0.5, -0.5), (0.5, 0.5))


def test_crossing_tapes_lie_one_above_the_other(arena):
    heights = [mesh.vertices[0][2] for mesh in geometry.tapes(arena.line, 1e-4, ["a"] * 6)]
    assert np.all(np.diff(heights) > 1e-6)

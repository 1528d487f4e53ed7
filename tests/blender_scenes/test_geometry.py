from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from blender_scenes.annotations.instances import instances
from blender_scenes.scene import line_mesh
from blender_scenes.scene.bevel import BEVEL_M
from blender_scenes.scene.description import Mesh
from blender_scenes.scene.run_scene import arena_bounds, describe
from configs.schema.appearance.look import LookConfig
from symolo.arena.geometry import Arc, Box, Line, Straight


def _normals_and_middles(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """By Newell's method, which holds for any planar polygon."""
    vertices = np.array(mesh.vertices)
    normals, middles = [], []
    for face in mesh.faces:
        p = vertices[list(face)]
        normals.append(np.cross(p, np.roll(p, -1, axis=0)).sum(axis=0))
        middles.append(p.mean(axis=0))
    return np.array(normals), np.array(middles)


def _tapes(line: Line, lift_m: float) -> list[Mesh]:
    surfaces = ["a"] * len(line.pieces)
    return line_mesh.tapes(line, surfaces, thickness_m=1e-4, gap_m=0.0, lift_m=lift_m, seed=1)


def _by_name(scene, prefix: str) -> list[Mesh]:
    return [mesh for mesh in scene.meshes if mesh.name.startswith(prefix)]


@pytest.fixture(scope="module")
def scene(arena, robot):
    return describe(arena, robot, LookConfig(name="plain"), seed=1)


def test_the_tapes_have_the_edges_that_the_line_sensor_reads(arena, scene):
    tapes = _by_name(scene, "tape_")
    edges = arena.line.edges(spacing_m=0.004)
    assert len(tapes) == len(edges) == 6
    gap = LookConfig(name="plain").tape.gap_m
    for mesh, (left, right), piece in zip(tapes, edges, arena.line.pieces, strict=True):
        rows = np.array(mesh.vertices).reshape(-1, 4, 3)
        s, offset = piece.local(rows[:, 0, :2])
        np.testing.assert_allclose(offset, -0.5 * arena.line.width_m, atol=1e-12)
        s_left, offset = piece.local(rows[:, -1, :2])
        np.testing.assert_allclose(offset, 0.5 * arena.line.width_m, atol=1e-12)
        for along in (s, s_left):
            assert along[[0, -1]] == pytest.approx([0.5 * gap, piece.length_m - 0.5 * gap], abs=1e-12)
        for corner, edge in ((rows[0, 0], right[0]), (rows[-1, -1], left[-1])):
            assert np.linalg.norm(corner[:2] - edge) == pytest.approx(0.5 * gap, rel=0.05)


def test_the_tapes_cover_what_the_line_covers(arena, scene):
    """Faces of the tapes against the sensor's own test of points, which knows nothing of meshes."""
    rng = np.random.default_rng(0)
    low, high = arena_bounds(arena)
    points = rng.uniform(low, high, (8000, 2))
    covered = np.zeros(len(points), dtype=bool)
    for mesh in _by_name(scene, "tape_"):
        vertices = np.array(mesh.vertices)[:, :2]
        for face in mesh.faces:
            a = vertices[list(face)]
            b = np.roll(a, -1, axis=0) - a
            near = np.flatnonzero(np.all((points >= a.min(axis=0)) & (points <= a.max(axis=0)), axis=1))
            delta = points[near, None] - a
            covered[near] |= np.all(b[:, 0] * delta[..., 1] - b[:, 1] * delta[..., 0] >= 0, axis=1)
    reads = arena.line.covers(points)
    assert reads.sum() > 100
    assert np.count_nonzero(covered != reads) <= 2  # chords of 4 mm stand 8 um off the arcs, joints gape by 0.4 mm


def test_the_tapes_lie_on_the_floor_but_for_lifted_edges_and_face_up(scene):
    own = LookConfig(name="plain").tape
    heights = []
    for mesh in _by_name(scene, "tape_"):
        rows = np.array(mesh.vertices).reshape(-1, 4, 3)
        assert 0 < rows[..., 2].min() < 2e-4
        assert np.ptp(rows[:, 1:3, 2]) == 0  # the middle sticks
        heights.append(np.ptp(rows[..., 2]))
        normals, _ = _normals_and_middles(mesh)
        assert np.all(normals[:, 2] > 0)
    assert 0.3 * own.lift_m < max(heights) <= own.lift_m


def test_lifts_that_meet_do_not_add_up(arena):
    surfaces = ["a"] * len(arena.line.pieces)
    for seed in range(60):
        for mesh in line_mesh.tapes(arena.line, surfaces, thickness_m=1e-4, gap_m=0.0, lift_m=1e-3, seed=seed):
            assert np.ptp([z for _, _, z in mesh.vertices]) <= 1e-3 + 1e-9


def test_a_tape_that_sticks_all_over_is_flat(arena):
    assert all(len({v[2] for v in mesh.vertices}) == 1 for mesh in _tapes(arena.line, lift_m=0.0))
    assert any(len({v[2] for v in mesh.vertices}) > 1 for mesh in _tapes(arena.line, lift_m=1e-3))


def _painted(arena, bleeding_m: float, seed: int = 1) -> list[np.ndarray]:
    """Distances outwards (N, 2) of both edges of each painted piece from those of the line."""
    half = 0.5 * arena.line.width_m
    meshes = line_mesh.paint(arena.line, "paint", thickness_m=5e-5, bleeding_m=bleeding_m, seed=seed)
    out = []
    for mesh, piece in zip(meshes, arena.line.pieces, strict=True):
        rows = np.array(mesh.vertices).reshape(-1, 2, 3)
        offsets = np.column_stack([piece.local(rows[:, side, :2])[1] for side in (0, 1)])
        out.append(np.column_stack([-offsets[:, 0], offsets[:, 1]]) - half)
    return out


def test_paint_bleeds_about_the_edge_that_the_line_sensor_reads(arena):
    for out in _painted(arena, 0.0004):
        assert np.abs(out).max() == pytest.approx(0.0004, rel=1e-6)
        assert np.abs(out.mean(axis=0)).max() < 1e-9
        assert np.abs(out[[0, -1]]).max() < 1e-12
        assert out.max() > -out.min()  # it creeps out further than it stays back
    assert all(np.abs(out).max() < 1e-12 for out in _painted(arena, 0.0))
    assert not np.array_equal(_painted(arena, 0.0004)[0], _painted(arena, 0.0004, seed=2)[0])


def test_paint_runs_on_from_piece_to_piece(arena):
    meshes = line_mesh.paint(arena.line, "paint", thickness_m=5e-5, bleeding_m=0.0004, seed=1)
    ends = [mesh.uv_m[-1][1][0] for mesh in meshes]
    assert ends == pytest.approx(np.cumsum([piece.length_m for piece in arena.line.pieces]))
    assert [mesh.uv_m[0][0][0] for mesh in meshes] == pytest.approx([0.0, *ends[:-1]])


def _in_box(mesh: Mesh, box: Box) -> np.ndarray:
    """Vertices (N, 3) in the box's own axes, from its middle."""
    c, s = np.cos(box.yaw_rad), np.sin(box.yaw_rad)
    return (np.array(mesh.vertices) - box.center) @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def test_each_box_fills_the_body_that_the_engine_collides_with_but_for_broken_edges(arena, scene):
    for box in arena.boxes:
        (mesh,) = _by_name(scene, f"{box.kind}_{box.name}")
        own, half = _in_box(mesh, box), 0.5 * np.array(box.size)
        np.testing.assert_allclose(own.max(axis=0), half, atol=1e-12)
        np.testing.assert_allclose(own.min(axis=0), -half, atol=1e-12)
        short = half - np.abs(own)  # of the box's faces; no vertex is further than the bevel from two of them
        assert np.all(np.sort(short, axis=1)[:, 1] <= BEVEL_M + 1e-12)


def test_broken_edges_close_the_box_but_for_its_bottom(arena, scene):
    """By the divergence theorem, for which the open bottom, in the plane z = 0, counts nothing."""
    for box in arena.boxes:
        (mesh,) = _by_name(scene, f"{box.kind}_{box.name}")
        vertices, six_volumes = np.array(mesh.vertices), 0.0
        for face in mesh.faces:
            p = vertices[list(face)]
            six_volumes += sum(float(np.dot(p[0], np.cross(p[i], p[i + 1]))) for i in range(1, len(p) - 1))
        (a, b, h), cut = box.size, BEVEL_M
        # Prisms of half a square cut off: upright edges below the upper ones, those with mitred ends, corners' shares.
        upright, upper = 4 * 0.5 * cut**2 * (h - cut), 2 * 0.5 * cut**2 * (a + b - 4 * cut)
        corners = 4 * cut**3 * 5 / 6  # of a cube at each corner only a pyramid over the two insets is left
        assert six_volumes / 6 == pytest.approx(a * b * h - upright - upper - corners, rel=1e-9)


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


def test_an_empty_arena_is_as_large_as_its_floor(arena):
    """So that the room of an imported trajectory, whose arena is unknown, holds the whole path."""
    empty = replace(arena, floor_half_extent_m=3.0, line=replace(arena.line, pieces=()), boxes=())
    assert arena_bounds(empty) == ((-3.0, -3.0), (3.0, 3.0))


def test_crossing_tapes_lie_one_above_the_other(arena):
    heights = [mesh.vertices[1][2] for mesh in _tapes(arena.line, lift_m=3e-4)]
    assert np.all(np.diff(heights) > 1e-6)


def test_joined_pieces_are_one_strip_without_a_joint():
    """Three joined pieces of a straight are the mesh of the whole straight, but for their levels."""
    cuts = [0.0, 0.5, 0.9, 1.4]
    pieces = tuple(Straight((a, 0.0), (b, 0.0)) for a, b in pairwise(cuts))
    (whole,) = _tapes(Line((Straight((0.0, 0.0), (1.4, 0.0)),), 0.015, 0.05), lift_m=0.0)
    (joined,) = line_mesh.tapes(
        Line(pieces, 0.015, 0.05, (False, True, True)), ["a"], thickness_m=1e-4, gap_m=0.0, lift_m=0.0, seed=1
    )
    rows = np.array(joined.vertices).reshape(-1, 4, 3)
    ends = np.array(whole.vertices).reshape(-1, 4, 3)
    np.testing.assert_allclose(rows[[0, -1], :, :2], ends[[0, -1], :, :2], atol=1e-12)
    assert np.diff(rows[:, 0, 0]).max() < 0.005
    # Later pieces are above earlier ones, so that a strip that crosses itself has no two faces in one plane.
    np.testing.assert_allclose(rows[:, 0, 2], 1e-4 + 2e-6 * np.searchsorted(cuts[1:-1], rows[:, 0, 0], side="right"))


def test_a_line_of_joined_arcs_is_one_instance_with_key_points_along_it(arena, robot):
    quarters = [Arc((0.0, 0.0), 0.5, 0.5 * np.pi * k, 0.5 * np.pi * (k + 1)) for k in range(4)]
    circle = replace(arena, line=Line(tuple(quarters), 0.015, 0.05, (False, True, True, True)))
    (strip,) = circle.line.strips
    assert strip.length_m == pytest.approx(np.pi)
    assert strip.curvature_per_m == pytest.approx(2.0)
    s = np.linspace(0.0, np.pi, 50)
    np.testing.assert_allclose(np.hypot(*strip.at(s, 0.1).T), 0.4)
    scene = describe(circle, robot, LookConfig(name="plain"), seed=1)
    assert len(_by_name(scene, "tape_")) == 1
    assert [one.name for one in instances(scene, circle).known if one.category == "line"] == ["line_0"]

"""What the rasteriser sees, against the camera's own projection, closed forms on the floor, and Cycles."""

from dataclasses import replace

import numpy as np
import pytest

from blender_scenes.preview.rasteriser import rasterise
from blender_scenes.preview.triangles import Triangles
from blender_scenes.scene import meshes as geometry
from blender_scenes.scene.description import LightPanel, Mesh
from blender_scenes.scene.run_scene import describe
from blender_scenes.scene.shading import Color, Surface
from configs.schema.appearance.look import LookConfig
from sensors.camera.views import FrameView
from symolo.arena.footprints import convex_outline
from symolo.core.geometry.pinhole import Intrinsics, floor_points, intrinsics, pose_X_RC, project
from symolo.core.geometry.poses import pose_X_WR

POSES = [(0.55, -0.60, 90), (0.545, -0.15, 92), (0.49, 0.68, 133), (-0.55, -0.90, -70), (0.30, -1.04, 15)]
"""x [m], y [m], yaw [deg]."""
IMAGE = Intrinsics(96, 72, 68.0, 68.0, 47.5, 35.5)


def eye_at(robot, pose, pitch_down_deg=30.0):
    x_m, y_m, yaw_deg = pose
    camera = robot.camera.model_copy(update={"pitch_down_deg": pitch_down_deg})
    return pose_X_WR(x_m, y_m, np.radians(yaw_deg)) @ pose_X_RC(camera, robot.chassis.base_height_m)


def of(*meshes: Mesh) -> Triangles:
    names = [name for mesh in meshes for name in mesh.face_surface]
    return Triangles.from_meshes(meshes, {name: number for number, name in enumerate(dict.fromkeys(names))})


def pixels_of(camera: Intrinsics) -> np.ndarray:
    """(H * W, 2), column and row of each, row by row."""
    row, column = np.indices((camera.height_px, camera.width_px))
    return np.stack([column.ravel(), row.ravel()], axis=1).astype(float)


@pytest.mark.parametrize("pose", POSES)
@pytest.mark.parametrize("yaw_deg", [0, 25, 60])
def test_a_box_covers_the_outline_of_its_projected_corners(robot, pose, yaw_deg):
    X_WC = eye_at(robot, pose)
    ahead = X_WC[:2, 3] + 0.4 * X_WC[:2, 2] / np.linalg.norm(X_WC[:2, 2])
    block = geometry.block("block", (0.0, 0.0, 0.06), (0.08, 0.1, 0.12), "card")
    box = of(block).placed(pose_X_WR(*ahead, np.radians(yaw_deg)))
    corners, depth = project(IMAGE, X_WC, box.corners.reshape(-1, 3))
    assert (depth > 0).all()
    outline = np.array(convex_outline([(float(u), float(v)) for u, v in corners]))
    side = np.roll(outline, -1, axis=0) - outline
    to_pixel = pixels_of(IMAGE)[:, None] - outline
    left = (side[:, 0] * to_pixel[..., 1] - side[:, 1] * to_pixel[..., 0]) / np.linalg.norm(side, axis=1)
    covered = rasterise(IMAGE, X_WC, box).triangle.ravel() >= 0
    assert covered.sum() > 100
    assert covered[left.min(axis=1) > 1e-6].all()
    assert not covered[left.min(axis=1) < -1e-6].any()


@pytest.mark.parametrize("pitch_down_deg", [0, 30, 90])
def test_the_floor_is_seen_where_its_rays_come_down(robot, pitch_down_deg):
    """It reaches below and behind the camera; surface coordinates and depth are those of the point met."""
    X_WC = eye_at(robot, (0.3, -0.2, 40), pitch_down_deg)
    floor = geometry.floor("floor", (-3.0, -2.0), (2.0, 3.0), 0.0, "floor")
    seen = rasterise(IMAGE, X_WC, of(floor))
    met = floor_points(IMAGE, X_WC, pixels_of(IMAGE))
    with np.errstate(invalid="ignore"):
        on_it = ((met[:, :2] > (-3.0, -2.0)) & (met[:, :2] < (2.0, 3.0))).all(axis=1)
    np.testing.assert_array_equal(seen.triangle.ravel() >= 0, on_it)
    assert on_it.sum() > 2000
    np.testing.assert_allclose(seen.uv_m.reshape(-1, 2)[on_it], met[on_it, :2], atol=1e-9)
    _, depth = project(IMAGE, X_WC, met[on_it])
    np.testing.assert_allclose(seen.depth_m.ravel()[on_it], depth, rtol=1e-9)
    assert np.isinf(seen.depth_m.ravel()[~on_it]).all()


@pytest.mark.parametrize("index", range(len(POSES)))
def test_the_edges_of_the_line_lie_where_straight_lines_are_projected_to(arena, robot, index):
    """Each row of a straight tape is covered from its one edge's image to the other's."""
    camera = intrinsics(robot.camera, 320, 240)
    piece = arena.line.pieces[0]
    ends, half = np.array([0.0, piece.length_m]), 0.5 * arena.line.width_m
    outline = np.concatenate([piece.at(ends, -half), piece.at(ends[::-1], half)])
    tape = geometry.rectangle("tape", [(float(x), float(y), 0.00013) for x, y in outline], "tape")
    x_m, _, yaw_deg = POSES[index]
    X_WC = eye_at(robot, (piece.start[0] + 0.1 * x_m, piece.start[1] + 0.1, 90 + 0.1 * yaw_deg))
    along = np.array([0.35, 0.75])
    images = []
    for side in (1, -1):
        flat = piece.at(along, side * half)
        images.append(project(camera, X_WC, np.column_stack([flat, [0.00013, 0.00013]]))[0])
    low, high = (int(np.ceil(max(image[1, 1] for image in images))), int(min(image[0, 1] for image in images)))
    assert high - low > 10
    covered = rasterise(camera, X_WC, of(tape)).triangle >= 0
    for row in range(low, high + 1):
        left, right = (a[0] + (row - a[1]) * (b[0] - a[0]) / (b[1] - a[1]) for a, b in images)
        columns = np.flatnonzero(covered[row])
        expected = np.arange(np.ceil(left), np.floor(right) + 1)
        np.testing.assert_array_equal(columns, expected[(expected >= 0) & (expected < 320)])


def test_faces_that_meet_leave_no_gap_and_each_pixel_sees_the_one_below_it(robot):
    """300 tiles, whose edges run along columns and rows of the image and across them."""
    parts = [
        geometry.floor(f"{i}_{j}", (0.1 * i, 0.1 * j), (0.1 * i + 0.1, 0.1 * j + 0.1), 0.0, f"{i}_{j}")
        for i in range(20)
        for j in range(15)
    ]
    triangles = of(*parts)
    for pose in ((0.4, 0.75, 0), (0.4, 0.75, 30)):
        X_WC = eye_at(robot, pose, 60)
        seen = rasterise(IMAGE, X_WC, triangles)
        met = floor_points(IMAGE, X_WC, pixels_of(IMAGE))[:, :2]
        np.testing.assert_array_less(-1, seen.triangle)
        tile = np.floor(met / 0.1).astype(int)
        inside = (np.abs(met / 0.1 - np.rint(met / 0.1)) > 1e-6).all(axis=1)
        expected = tile[:, 0] * 15 + tile[:, 1]
        np.testing.assert_array_equal(triangles.surface[seen.triangle.ravel()][inside], expected[inside])


def facing(z_m: float, surface: str, *, back: bool = False) -> Mesh:
    """A square metre across the z axis."""
    corners = ((-0.5, -0.5, z_m), (0.5, -0.5, z_m), (0.5, 0.5, z_m), (-0.5, 0.5, z_m))
    return geometry.rectangle(surface, corners[::-1] if back else corners, surface)


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("order", [1, -1])
def test_the_nearest_surface_is_seen_from_either_side_in_whichever_order(back, order):
    meshes = [facing(1.0, "near", back=back), facing(1.000002, "far")][::order]
    seen = rasterise(IMAGE, np.eye(4), of(*meshes))
    shown = {meshes[number].name for number in np.unique(of(*meshes).surface[seen.triangle[30:40, 40:50]])}
    assert shown == {"near"}


def test_nothing_is_seen_closer_than_a_millimetre_or_behind():
    seen = rasterise(IMAGE, np.eye(4), of(facing(0.0009, "too near"), facing(-1.0, "behind"), facing(2.0, "far")))
    assert set(np.unique(seen.triangle)) <= {-1, 4, 5}
    assert seen.depth_m[36, 48] == pytest.approx(2.0)


def test_a_face_that_is_not_convex_is_refused():
    arrow = ((0.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 0.3, 0.0), (-1.0, 1.0, 0.0))
    with pytest.raises(ValueError, match="mesh arrow: face 0 is not convex"):
        of(geometry.rectangle("arrow", arrow[1:] + arrow[:1], "paint"))


RED, GREEN, BLUE, YELLOW, CYAN, MAGENTA, BLACK = 4, 2, 1, 6, 3, 5, 0
COLORS = {
    "floor": RED,
    "tape": BLUE,
    "wall": GREEN,
    "obstacle": YELLOW,
    "room_wall": CYAN,
    "room_ceiling": MAGENTA,
    "room_skirting": GREEN,
    "window_frame": RED,
}
"""Bits of the channels that a surface returns, by how its name begins."""


def _code(surface: str) -> int:
    return next((code for start, code in COLORS.items() if surface.startswith(start)), BLACK)


def _flash(X_WC: np.ndarray) -> LightPanel:
    """A white lamp around the camera's eye: it throws no shadow that the camera sees."""
    right, down = (tuple(X_WC[:3, axis].tolist()) for axis in (0, 1))
    return LightPanel("flash", tuple(X_WC[:3, 3].tolist()), right, down, 0.02, 0.02, (9.0, 9.0, 9.0))


def test_cycles_sees_the_same_surfaces(arena, robot, light_of):
    """Every surface in a colour of the cube's corners and lit from the camera, so that the light's channels name it."""
    pixels, focal_px = 48, 37.5
    scene = describe(arena, robot, LookConfig(name="plain"), 3)
    surfaces = []
    for surface in scene.surfaces:
        rgb = tuple(0.8 * (_code(surface.name) >> bit & 1) for bit in (2, 1, 0))
        surfaces.append(Surface(surface.name, Color(rgb), roughness=1.0, refractive_index=1.0))
    eyes = [eye_at(robot, pose, pitch) for pose, pitch in zip(POSES[1:4], (30, 5, -10), strict=True)]
    lit = replace(
        scene,
        surfaces=tuple(surfaces),
        robot=(),
        panels=tuple(_flash(X_WC) for X_WC in eyes),
        sun=None,
        sky=replace(scene.sky, gain=0.0),
    )
    views = [FrameView(i, 0.0, (9.0, 9.0, 0.0), tuple(map(tuple, X_WC.tolist()))) for i, X_WC in enumerate(eyes)]
    light = light_of(lit, views, pixels, focal_px)
    bright = light > 0.25 * np.maximum(light.max(axis=-1, keepdims=True), 1e-6)
    in_cycles = bright @ np.array([4, 2, 1])
    camera = Intrinsics(pixels, pixels, focal_px, focal_px, 0.5 * (pixels - 1), 0.5 * (pixels - 1))
    triangles = Triangles.from_meshes(scene.meshes, {surface.name: i for i, surface in enumerate(scene.surfaces)})
    codes = np.array([*(_code(surface.name) for surface in scene.surfaces), BLACK])
    compared = set()
    for X_WC, theirs in zip(eyes, in_cycles, strict=True):
        triangle = rasterise(camera, X_WC, triangles).triangle
        ours = codes[np.where(triangle >= 0, triangles.surface[triangle], -1)]
        inner = ours[1:-1, 1:-1]
        around = [ours[i : pixels - 2 + i, j : pixels - 2 + j] for i in range(3) for j in range(3)]
        clear = np.logical_and.reduce([inner == other for other in around])
        assert clear.mean() > 0.7
        compared |= set(inner[clear].tolist())
        assert (theirs[1:-1, 1:-1] == inner)[clear].mean() >= 0.98
    assert compared >= {RED, BLUE, GREEN, YELLOW, CYAN}

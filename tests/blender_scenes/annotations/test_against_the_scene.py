"""What the pass without noise says, against the arena by closed forms and against PyBullet's own rays."""

import hashlib
from dataclasses import replace

import cv2
import numpy as np
import pytest

from blender_scenes.render.renderer import render_job
from physics.bullet.ray_oracle import EngineRays
from symolo.core.geometry.pinhole import floor_points, matrix_K, project
from symolo.dataset.annotations import CATEGORIES

NUMBERS = (1, 2, 3)
ROOM = CATEGORIES.index("room")
TENTH_MM = 1e-4


def pixels_of(annotated):
    camera = annotated.job.camera
    v, u = np.indices((camera.height_px, camera.width_px))
    return np.stack([u.ravel(), v.ravel()], axis=1).astype(float)


def rays_W(annotated, number):
    """(N, 3), length 1 along the axis, by the inverse of the camera matrix."""
    uv1 = np.column_stack([pixels_of(annotated), np.ones(len(pixels_of(annotated)))])
    return uv1 @ np.linalg.inv(matrix_K(annotated.job.camera)).T @ annotated.X_WC(number)[:3, :3].T


def at_its_time(annotated, number):
    """The arena with its moving obstacle standing where it is in an image."""
    t_s = annotated.document.images[number - 1].t_s
    boxes = []
    for box in annotated.arena.boxes:
        x, y, yaw = box.poses_at(np.array([t_s]))[0]
        boxes.append(replace(box, center=(float(x), float(y), box.center[2]), yaw_rad=float(yaw), motion=None))
    return replace(annotated.arena, boxes=tuple(boxes))


@pytest.mark.parametrize("number", NUMBERS)
def test_each_id_that_is_seen_is_in_the_table_and_of_its_category(annotated, number):
    ids, categories = annotated.image("instance", number), annotated.image("semantic", number)
    assert (ids.dtype, categories.dtype) == (np.uint16, np.uint8)
    table = {0: 0} | {one.id: one.category_id for one in annotated.document.instances}
    assert set(np.unique(ids)) <= set(table)
    assert np.array_equal(np.vectorize(table.get)(ids), categories)
    for name in ("floor", "line_0", "pane", "board", "cube", "cart"):
        assert np.any(ids == annotated.id_of(name)), name


@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize("name", ["cube", "cart"])
def test_a_mask_is_the_hull_of_the_projected_corners(annotated, name, number):
    """Nothing stands before these two; a pixel counts by its middle, and less than a tenth of one is left open."""
    pixels, depth = project(annotated.job.camera, annotated.X_WC(number), annotated.corners_W(name, number))
    assert np.all(depth > 0)
    hull = cv2.convexHull(pixels.astype(np.float32))
    mask = annotated.image("instance", number) == annotated.id_of(name)
    assert mask.sum() > 20
    away = [cv2.pointPolygonTest(hull, (float(u), float(v)), measureDist=True) for u, v in pixels_of(annotated)]
    inside = np.reshape(away, mask.shape)
    clear = np.abs(inside) > 0.1
    assert np.array_equal(mask[clear], inside[clear] > 0)


@pytest.mark.parametrize("number", NUMBERS)
def test_depth_is_that_of_the_physics_engines_rays(annotated, number):
    depth, rays = annotated.depth_m(number).ravel(), rays_W(annotated, number)
    eye = np.tile(annotated.X_WC(number)[:3, 3], (len(rays), 1))
    with EngineRays(at_its_time(annotated, number)) as engine:
        hits = engine.cast(eye, eye + 3.0 * rays)
    arena = (annotated.image("semantic", number).ravel() != ROOM) & (hits.surface >= 0)
    error = np.abs(depth - 3.0 * hits.fraction)[arena]
    assert arena.sum() > 4500
    assert np.median(error) < 0.0003
    assert np.mean(error < 0.001) > 0.98  # the engine rounds edges
    names = [*annotated.arena.boxes]
    ids = np.array([0, *(annotated.id_of(box.name) for box in names)])[hits.surface]
    met = (hits.surface > 0) & arena
    assert np.mean(annotated.image("instance", number).ravel()[met] == ids[met]) > 0.97


@pytest.mark.parametrize("number", NUMBERS)
def test_depth_of_the_floor_is_exact_to_its_last_digit(annotated, number):
    X_WC = annotated.X_WC(number)
    points = floor_points(annotated.job.camera, X_WC, pixels_of(annotated))
    expected = ((points - X_WC[:3, 3]) @ X_WC[:3, 2]).reshape(annotated.image("depth", number).shape)
    floor = (annotated.image("instance", number) == annotated.id_of("floor")) & (expected < 6.4)
    np.testing.assert_allclose(annotated.depth_m(number)[floor], expected[floor], atol=0.51 * TENTH_MM)


@pytest.mark.parametrize("number", [1, 2])
def test_flow_on_the_floor_is_the_homography_of_its_plane(annotated, number):
    """H = K (R + t n' / d) K^-1 for the plane n' p = d (Hartley and Zisserman, Multiple View Geometry, eq. 13.2)."""
    K, X_WC, X_WD = matrix_K(annotated.job.camera), annotated.X_WC(number), annotated.X_WC(number + 1)
    X_DC = np.linalg.inv(X_WD) @ X_WC
    normal_C, height = X_WC[2, :3], -X_WC[2, 3]  # z_W = 0 is n' p_C = -height of the camera
    H = K @ (X_DC[:3, :3] + np.outer(X_DC[:3, 3], normal_C) / height) @ np.linalg.inv(K)
    pixels = pixels_of(annotated)
    there = np.column_stack([pixels, np.ones(len(pixels))]) @ H.T
    expected = there[:, :2] / there[:, 2:] - pixels
    coded = annotated.image("flow", number).reshape(-1, 3).astype(float)
    seen = (annotated.image("instance", number).ravel() == annotated.id_of("floor")) & (coded[:, 2] == 1)
    assert seen.sum() > 2000
    np.testing.assert_allclose((coded[seen, :2] - 32768) / 64, expected[seen], atol=1 / 128 + 1e-6)


@pytest.mark.parametrize("name", ["cart", "board"])
def test_flow_of_a_body_takes_its_corners_along(annotated, name):
    """A corner's neighbourhood moves as the corner: within a pixel of it the flow differs by less than half of one."""
    camera = annotated.job.camera
    before, depth = project(camera, annotated.X_WC(1), annotated.corners_W(name, 1))
    after, _ = project(camera, annotated.X_WC(2), annotated.corners_W(name, 2))
    flow = (annotated.image("flow", 1)[..., :2].astype(float) - 32768) / 64
    mask, image_depth = annotated.image("instance", 1) == annotated.id_of(name), annotated.depth_m(1)
    compared = 0
    for corner, change, z in zip(before, after - before, depth, strict=True):
        u, v = np.rint(corner).astype(int)
        near = [(v + i, u + k) for i in (-1, 0, 1) for k in (-1, 0, 1)]
        near = [at for at in near if 0 <= at[0] < camera.height_px and 0 <= at[1] < camera.width_px and mask[at]]
        for at in near:
            if abs(image_depth[at] - z) < 0.02:
                compared += 1
                np.testing.assert_allclose(flow[at], change, atol=0.5)
    assert compared >= 4


def test_the_last_image_has_no_flow(annotated):
    assert sorted(path.name for path in (annotated.folder / "flow").iterdir()) == ["000001.png", "000002.png"]


def test_normals_are_those_of_the_planes(annotated):
    ids, R_WC = annotated.image("instance", 2), annotated.X_WC(2)[:3, :3]
    normal_W = ((annotated.image("normals", 2).astype(float) - 32768) / 32767) @ R_WC.T
    for name, expected in (("floor", (0, 0, 1)), ("line_0", (0, 0, 1)), ("pane", (-1, 0, 0)), ("board", (-1, 0, 0))):
        own = normal_W[ids == annotated.id_of(name)]
        assert np.mean(np.abs(own - expected).max(axis=1) < 1e-4) > 0.9, name  # a pane shows its rim too
    c, s = np.cos(np.radians(20)), np.sin(np.radians(20))
    own = normal_W[ids == annotated.id_of("cube")]
    sides = np.array([(-c, -s, 0), (s, -c, 0), (-s, c, 0), (0, 0, 1)])
    assert np.mean(np.abs(own[:, None] - sides).max(axis=2).min(axis=1) < 1e-4) > 0.97


@pytest.mark.parametrize("number", NUMBERS)
def test_on_the_free_floor_stands_nothing(annotated, number):
    free = annotated.image("free_floor", number) == 255
    semantic = annotated.image("semantic", number)
    assert np.array_equal(free, np.isin(semantic, [CATEGORIES.index("floor"), CATEGORIES.index("line")]))
    points = floor_points(annotated.job.camera, annotated.X_WC(number), pixels_of(annotated))[free.ravel(), :2]
    for name in ("pane", "board", "cube", "cart"):
        outline = annotated.corners_W(name, number)[:4, :2].astype(np.float32)
        inside = [cv2.pointPolygonTest(outline, (float(x), float(y)), measureDist=True) for x, y in points]
        assert max(inside) < 1e-4, name


@pytest.mark.parametrize("number", NUMBERS)
def test_a_key_point_is_visible_where_the_engines_ray_reaches_it(annotated, number):
    own = [one for one in annotated.document.sightings if one.image_id == number]
    X_WC = annotated.X_WC(number)
    points = np.array([one.p_C for one in own]) @ X_WC[:3, :3].T + X_WC[:3, 3]
    pixels, _ = project(annotated.job.camera, X_WC, points)
    np.testing.assert_allclose(pixels, [one.pixel for one in own], atol=1e-3)
    eye = np.tile(X_WC[:3, 3], (len(points), 1))
    way = np.linalg.norm(points - eye, axis=1)
    with EngineRays(at_its_time(annotated, number)) as engine:
        left = way * (1 - engine.cast(eye, points).fraction)
    # A corner is where the engine rounds: a ray that ends within 5 mm of the point has reached it.
    assert [one.visible for one in own] == (left < 0.005).tolist()
    assert {one.visible for one in own} == {True, False}
    corners = {f"{name}_{k}": p for name in ("cube", "cart") for k, p in enumerate(annotated.corners_W(name, number))}
    names = {point.id: point.name for point in annotated.document.key_points}
    for one, point in zip(own, points, strict=True):
        if names[one.key_point_id] in corners:
            np.testing.assert_allclose(point, corners[names[one.key_point_id]], atol=1e-8)


def test_a_damaged_file_is_made_again_alone_and_threads_change_no_byte(annotated):
    paths = [path for path in annotated.folder.rglob("*") if path.is_file()]
    before = {path: (hashlib.sha256(path.read_bytes()).hexdigest(), path.stat().st_mtime_ns) for path in paths}
    damaged = annotated.folder / "depth/000002.png"
    damaged.write_bytes(damaged.read_bytes()[:-30])
    again = render_job(annotated.folder.with_name("job.json"), annotated.folder, work="annotations", threads=2)
    assert again.made == 1
    assert [file.file for file in again.files if file.number == 2] == list(annotated.job.files(2))
    assert {path: hashlib.sha256(path.read_bytes()).hexdigest() for path in paths} == {
        k: v[0] for k, v in before.items()
    }
    others = [path for path in paths if path.stem != "000002"]
    assert all(path.stat().st_mtime_ns == before[path][1] for path in others)


def test_boxes_are_those_of_the_masks_and_lie_within_those_of_the_whole(annotated):
    names = {one.id: one.name for one in annotated.document.instances}
    assert {names[one.instance_id] for one in annotated.document.annotations} == {"pane", "board", "cube", "cart"}
    for one in annotated.document.annotations:
        mask = annotated.image("instance", one.image_id) == one.instance_id
        y, x = np.nonzero(mask)
        assert one.area == len(x)
        assert one.bbox == (x.min(), y.min(), x.max() + 1 - x.min(), y.max() + 1 - y.min())
        (x0, y0, w0, h0), (x1, y1, w1, h1) = one.bbox, one.amodal_bbox
        assert x1 <= x0
        assert y1 <= y0
        assert x0 + w0 <= x1 + w1
        assert y0 + h0 <= y1 + h1
        assert one.visible_fraction == pytest.approx(one.area / one.amodal_area, abs=1e-6)
        if names[one.instance_id] in {"cube", "cart"}:  # which nothing hides
            assert one.visible_fraction > 0.97
        else:
            assert one.visible_fraction < 0.95


@pytest.mark.parametrize("name", ["pane", "board"])
def test_of_a_thing_partly_hidden_the_engine_gives_the_same_full_box(annotated, name):
    """The whole is what its rays meet in an arena in which it stands alone."""
    alone = at_its_time(annotated, 1)
    alone = replace(alone, boxes=tuple(box for box in alone.boxes if box.name == name))
    rays = rays_W(annotated, 1)
    eye = np.tile(annotated.X_WC(1)[:3, 3], (len(rays), 1))
    with EngineRays(alone) as engine:
        met = engine.cast(eye, eye + 3.0 * rays).surface == 1
    number = annotated.id_of(name)
    (one,) = [one for one in annotated.document.annotations if (one.image_id, one.instance_id) == (1, number)]
    assert one.amodal_area == pytest.approx(met.sum(), rel=0.03)

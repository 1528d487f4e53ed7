"""Boxes, key points and encodings by closed forms, on passes written by hand; no Blender."""

from dataclasses import replace
from typing import get_args

import numpy as np
import pytest

from blender_scenes.annotations.boxes import box_2d, box_3d, reaches_beyond, silhouette
from blender_scenes.annotations.images import IMAGE_ANNOTATIONS, depth, flow, normals
from blender_scenes.annotations.instances import instances
from blender_scenes.annotations.job import build_annotation_job
from blender_scenes.annotations.occlusion import hidden, triangles
from blender_scenes.annotations.record import FrameRecord, record
from blender_scenes.annotations.visible_scene import Passes, VisibleScene
from blender_scenes.scene.description import Mesh
from blender_scenes.scene.meshes import block
from sensors.camera.views import FrameView
from symolo.core.geometry.pinhole import Intrinsics, matrix_K
from symolo.core.geometry.poses import pose_X_WR
from symolo.dataset.annotations import ENCODINGS, RECORD_KINDS, AnnotationName, pixel_box

WIDTH, HEIGHT, FOCAL = 80, 60, 50.0
CAMERA = Intrinsics(WIDTH, HEIGHT, FOCAL, FOCAL, 39.5, 29.5)
AHEAD = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0.06], [0, 0, 0, 1.0]])
"""X_WC of a camera 6 cm above the origin that looks along +x, level."""


def rows(matrix):
    return tuple(tuple(float(x) for x in row) for row in matrix)


@pytest.fixture
def job(small, images_job):
    """The small arena with its cube 1 m ahead, square to the camera, 0.2 m wide and high, and its cart behind it."""
    *others, _, cart = small.boxes
    cube = replace(small.boxes[2], center=(1.1, 0.0, 0.1), size=(0.2, 0.2, 0.2), yaw_rad=0.0)
    arena = replace(small, boxes=(*others, cube, cart))
    views = tuple(FrameView(i + 1, 0.2 * i, (0.0, 0.0, 0.0), rows(AHEAD), ((-0.5, 0.0, 0.0),)) for i in range(2))
    return build_annotation_job(replace(images_job, camera=CAMERA, frames=views), arena, ("boxes_2d", "boxes_3d"))


def seen(job, mesh=None, **passes):
    shape = HEIGHT, WIDTH
    empty = {"point_W": np.zeros((*shape, 3)), "normal_W": np.zeros((*shape, 3))}
    mesh = np.zeros(shape, dtype=int) if mesh is None else mesh
    return VisibleScene(job, job.frames[0], job.following(1), Passes(mesh, **(empty | passes)))


def solid_named(job, name):
    number = next(one.id for one in job.instances.known if one.name == name)
    return next(solid for solid in job.solids if solid.instance_id == number)


def test_the_silhouette_of_a_square_face_is_its_similar_triangle(job):
    """1 m ahead, 0.2 m are 10 px; from 6 cm below the camera to 14 cm above: 3 px below its middle to 7 above."""
    mask = silhouette(seen(job), solid_named(job, "cube"))
    assert pixel_box(mask) == (35, 23, 10, 10)
    assert mask.sum() == 100


def test_the_silhouette_of_triangles_is_theirs_and_not_that_of_their_bounding_box(job):
    """Half of the square face above, cut along its diagonal: 45 of 100 pixels and some of the 10 on the diagonal."""
    corners = ((1.0, -0.1, 0.0), (1.0, 0.1, 0.0), (1.0, 0.1, 0.2))
    uv_m = tuple((y, z) for _, y, z in corners)
    plate = Mesh("obstacle_cube", corners, ((0, 1, 2),), (uv_m,), ("plain",))
    meshes = tuple(plate if mesh.name == plate.name else mesh for mesh in job.scene.meshes)
    assert plate in meshes
    cut = replace(job, scene=replace(job.scene, meshes=meshes))
    mask = silhouette(seen(cut), solid_named(cut, "cube"))
    assert pixel_box(mask)[:2] == (35, 23)  # y grows to the left in the image
    assert 45 <= mask.sum() <= 55
    assert mask[32, 35:45].sum() >= 9
    assert mask[23, 35:45].sum() <= 1


def test_boxes_and_fraction_of_a_thing_that_is_half_hidden(job):
    cube = solid_named(job, "cube")
    mesh = np.zeros((HEIGHT, WIDTH), dtype=int)
    mesh[23:33, 35:40] = job.instances.of_mesh.index(cube.instance_id)
    frame = seen(job, mesh)
    box = box_2d(frame, cube, silhouette(frame, cube))
    assert (box.bbox, box.area) == ((35, 23, 5, 10), 50)
    assert (box.amodal_bbox, box.amodal_area) == ((35, 23, 10, 10), 100)
    assert box.visible_fraction == 0.5
    assert not box.truncated


def test_a_thing_behind_the_camera_is_in_no_image_and_one_across_the_border_is_truncated(job):
    frame = seen(job)
    assert not silhouette(frame, solid_named(job, "cart")).any()
    assert "cart" not in {job.instances.known[thing.instance_id - 1].name for thing in record(frame).things}
    # The board, 1.28 m ahead and 1.2 m wide, is 47 px; seen from 0.5 m it is cut off at both borders.
    board = solid_named(job, "board")
    assert pixel_box(silhouette(frame, board))[2] == 46  # columns 39.5 +- 23.4, whose middles are 17 to 62
    near = pose_X_WR(0.78, 0.0, 0.0) @ AHEAD
    closer = replace(frame, view=replace(frame.view, X_WC=rows(near)))
    whole = silhouette(closer, board)
    assert pixel_box(whole)[::2] == (0, WIDTH)
    assert box_2d(closer, board, whole).truncated


def test_a_thing_that_reaches_beyond_the_fold_of_a_lens_is_truncated(job):
    """Where the model alone would bring its ends back into the image: r (1 - 0.12 r^2) falls from r = 1.67 on."""
    folding = replace(job, camera=replace(job.camera, distortion=(-0.12, 0.0, 0.0, 0.0, 0.0)))
    board = solid_named(job, "board")
    _, depth_m, height_m = board.size_m  # its length is across, for the wall stands across the view
    ends = np.array([2.6, 2.7])  # of the far and the near face, to each side
    brought_back = job.camera.cx_px + job.camera.fx_px * ends * (1 - 0.12 * ends**2)
    assert np.all(brought_back < WIDTH - 0.5)
    assert not reaches_beyond(seen(folding), replace(board, size_m=(0.8, depth_m, height_m)))
    assert reaches_beyond(seen(folding), replace(board, size_m=(2 * 2.7 * 1.28, depth_m, height_m)))


def test_what_is_hidden_altogether_has_a_box_around_all_of_it_and_none_around_what_is_seen(job):
    thing = next(t for t in record(seen(job)).things if t.instance_id == solid_named(job, "cube").instance_id)
    assert thing.box_2d is not None
    assert (thing.box_2d.bbox, thing.box_2d.visible_fraction) == ((0, 0, 0, 0), 0.0)
    assert thing.box_2d.amodal_bbox == (35, 23, 10, 10)


def test_a_record_is_read_back_as_it_was(job):
    one = record(seen(job))
    assert FrameRecord.from_json(one.to_json()) == one


def test_the_box_in_space_stands_where_the_arena_has_it(job):
    box = box_3d(seen(job), solid_named(job, "cube"))
    assert box.size_m == (0.2, 0.2, 0.2)
    np.testing.assert_allclose(np.array(box.X_WO)[:3, 3], (1.1, 0.0, 0.1))
    np.testing.assert_allclose(np.array(box.X_CO)[:3, 3], (0.0, -0.04, 1.1), atol=1e-9)
    moved = box_3d(seen(job), solid_named(job, "cart"))
    np.testing.assert_allclose(np.array(moved.X_WO)[:3, 3], (-0.5, 0.0, 0.045))


def test_depth_is_taken_where_the_plane_cuts_the_ray_through_the_pixels_middle(job):
    """Points of the floor met 0.4 px off the middles: z = f h / (v - cy) in 0.1 mm, none above the horizon."""
    u, v = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    down = (v + 0.4 - 29.5) / FOCAL
    far = np.where(down > 0, 0.06 / np.where(down > 0, down, 1.0), 0.0)
    point_W = np.stack([far, -far * (u + 0.4 - 39.5) / FOCAL, np.zeros_like(far)], axis=-1)
    normal_W = np.broadcast_to([0.0, 0.0, 1.0], point_W.shape)
    image = depth(seen(job, (down > 0).astype(int), point_W=point_W, normal_W=normal_W))
    rows_below = np.arange(30, HEIGHT)
    assert image.dtype == np.uint16
    expected = np.rint(1e4 * FOCAL * 0.06 / (rows_below - 29.5))
    assert np.array_equal(image[30:], np.broadcast_to(expected[:, None], (HEIGHT - 30, WIDTH)))
    assert not image[:30].any()


def test_what_is_beyond_the_range_has_no_depth(job):
    for far, expected in ((6.4, 64_000), (6.6, 0)):
        point_W = np.broadcast_to([far, 0.0, 0.06], (HEIGHT, WIDTH, 3))
        normal_W = np.broadcast_to([-1.0, 0.0, 0.0], (HEIGHT, WIDTH, 3))
        image = depth(seen(job, np.ones((HEIGHT, WIDTH), dtype=int), point_W=point_W, normal_W=normal_W))
        assert np.all(image == expected)


def test_the_sky_turns_with_the_camera_by_the_homography_of_infinity(job):
    """K R K^-1 (Hartley and Zisserman, eq. 13.12), also while the camera moves on."""
    turned = pose_X_WR(0.3, -0.2, 0.1) @ AHEAD
    frame = replace(seen(job), following=replace(job.frames[1], X_WC=rows(turned)))
    coded = flow(frame)
    K = matrix_K(CAMERA)
    H = K @ turned[:3, :3].T @ AHEAD[:3, :3] @ np.linalg.inv(K)
    there = H @ (10.0, 20.0, 1.0)
    assert coded is not None
    assert coded[20, 10, 2] == 1
    np.testing.assert_allclose(
        (coded[20, 10, :2].astype(float) - 32768) / 64, there[:2] / there[2] - (10, 20), atol=1 / 128 + 1e-9
    )


def test_flow_that_leads_behind_the_camera_or_too_far_is_not_valid(job):
    frame = seen(job)
    backwards = replace(frame, following=replace(job.frames[1], X_WC=rows(pose_X_WR(0, 0, np.pi) @ AHEAD)))
    nearly = replace(frame, following=replace(job.frames[1], X_WC=rows(pose_X_WR(0, 0, 1.55) @ AHEAD)))
    for following in (backwards, nearly):
        coded = flow(following)
        assert coded is not None
        assert not coded[30, 40].any()
    assert flow(replace(frame, following=None)) is None


def test_normals_are_written_in_the_cameras_frame(job):
    """Towards a camera that looks along +x: -z in C."""
    mesh = np.zeros((HEIGHT, WIDTH), dtype=int)
    mesh[0, 0] = 1
    normal_W = np.broadcast_to([-1.0, 0.0, 0.0], (HEIGHT, WIDTH, 3))
    image = normals(seen(job, mesh, normal_W=normal_W))
    assert image[0, 0].tolist() == [32768, 32768, 1]
    assert image[1, 1].tolist() == [0, 0, 0]


def test_a_cube_hides_what_lies_behind_it_and_its_own_back_but_not_its_front():
    """A camera that looks along z at a cube of 0.2 m, 1 m away; the last point lies beside it, seen past its edge."""
    screens = triangles(block("cube", (0.0, 0.0, 1.0), (0.2, 0.2, 0.2), "any"))
    assert screens.shape == (12, 3, 3)
    points = np.array([(0, 0, 2), (0.25, 0, 2), (0, 0, 0.5), (0.1, 0.1, 0.9), (0.1, 0.1, 1.1), (0, 0.101, 0.9)], float)
    assert hidden(points, screens).tolist() == [True, False, False, False, True, False]
    assert hidden(np.empty((0, 3)), screens).tolist() == []
    assert hidden(points, np.empty((0, 3, 3))).tolist() == [False] * 6
    turned_away = screens * (1, 1, -1)
    assert hidden(points, turned_away).tolist() == [False] * 6


def test_a_wall_that_begins_behind_the_camera_hides_what_is_beyond_it():
    screens = np.array([[(-1.0, -5, -3), (-1, 5, -3), (-1, 0, 40)]])
    assert hidden(np.array([(-2.0, 0, 3), (-0.9, 0, 3), (2, 0, 3)]), screens).tolist() == [True, False, False]


def test_a_scene_of_another_arena_is_refused(small, images_job):
    with pytest.raises(ValueError, match="is not of arena"):
        instances(images_job.scene, replace(small, boxes=small.boxes[:3]))


def test_every_part_of_the_robot_is_one_instance(small, images_job):
    scene = images_job.scene
    known = instances(scene, small)
    robot = known.named("robot", "robot").id
    assert known.of_mesh[len(scene.meshes) + 1 : len(scene.meshes) + len(scene.robot) + 1] == (robot,) * len(
        scene.robot
    )
    assert sorted(set(known.of_mesh)) == list(range(len(known.known) + 1))


def test_materials_and_light_play_no_part(small, images_job):
    """So that another look in the same room has the same annotations, and what is there is kept."""
    dark = replace(
        images_job,
        response=replace(images_job.response, brightness=0.1),
        sampling=replace(images_job.sampling, samples=9),
    )
    kinds = ("depth", "flow")
    assert (
        build_annotation_job(dark, small, kinds).to_json() == build_annotation_job(images_job, small, kinds).to_json()
    )


def test_a_frame_has_a_file_for_each_map_and_one_for_all_records(job):
    both = replace(job, kinds=("depth", "flow", "boxes_2d", "key_points"))
    assert both.files(1) == ("depth/000001.png", "flow/000001.png", "records/000001.json")
    assert both.files(2) == ("depth/000002.png", "records/000002.json")
    assert replace(job, kinds=("semantic",)).files(2) == ("semantic/000002.png",)


def test_every_annotation_has_a_member_and_an_encoding():
    names = set(get_args(AnnotationName))
    assert set(IMAGE_ANNOTATIONS) == names - set(RECORD_KINDS)
    assert set(ENCODINGS) == names

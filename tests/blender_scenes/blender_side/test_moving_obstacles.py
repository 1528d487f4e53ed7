"""Moving obstacles in the render job, and in Cycles' light against a closed form of lid and shadow."""

import json
from dataclasses import replace

import numpy as np
import pytest

from blender_scenes.render.job import FramePose, RenderJob, build_job
from blender_scenes.scene.description import Scene, Sky, Sun
from blender_scenes.scene.meshes import block, box_corners, floor
from blender_scenes.scene.run_scene import arena_bounds
from blender_scenes.scene.shading import Color, Surface
from configs.schema.appearance.look import LookConfig
from configs.schema.scenario import Render
from sensors.camera.views import FrameView
from symolo.arena.obstacle_motion import ObstacleMotion

FRAMES = [FramePose(number=i, t_s=0.2 * i, x_m=0.55, y_m=-0.6, yaw_rad=1.57) for i in (1, 2, 3)]
SIZE_M, HEIGHT_M = 0.1, 2.0
SUN = 3.0
LONGEST_NAME = "obstacle_" + 64 * "c"
"""Blender keeps 63 bytes of it."""


@pytest.fixture
def moving(arena):
    """The shipped arena with its second obstacle on the way from (0.55, 0.15) to (1.55, 0.65) in 1 s, turning."""
    path = ObstacleMotion((0.0, 1.0), ((0.55, 0.15, 0.0), (1.55, 0.65, 1.0)), repeats=False)
    *others, last = arena.boxes
    return replace(arena, boxes=(*others, replace(last, motion=path)))


def job_of(arena, robot):
    return build_job(arena, robot, LookConfig(name="plain"), Render(), FRAMES, seed=5)


def test_each_frame_says_where_the_obstacle_is_at_its_time(moving, robot):
    job = job_of(moving, robot)
    assert [mesh.name for mesh in job.scene.moving] == ["obstacle_O2"]
    assert "obstacle_O2" not in {mesh.name for mesh in job.scene.meshes}
    expected = [(0.55 + share, 0.15 + 0.5 * share, share) for share in (0.2, 0.4, 0.6)]
    np.testing.assert_allclose([view.moving[0] for view in job.frames], expected)
    assert RenderJob.from_json(job.to_json()) == job


def test_placed_by_its_pose_the_mesh_is_the_box_that_the_engine_collides_with(moving, robot):
    job = job_of(moving, robot)
    (mesh,) = job.scene.moving
    (box,) = moving.moving
    for view in job.frames:
        x, y, yaw = view.moving[0]
        c, s = np.cos(yaw), np.sin(yaw)
        placed = np.array(mesh.vertices) @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + (x, y, 0)
        there = replace(box, center=(x, y, box.center[2]), yaw_rad=yaw)
        corners = box_corners(there)
        edges = corners[[1, 3, 4]] - corners[0]  # of its length, width and height
        shares = (placed - corners[0]) @ (edges / np.sum(edges**2, axis=1, keepdims=True)).T
        np.testing.assert_allclose([shares.min(axis=0), shares.max(axis=0)], [(0, 0, 0), (1, 1, 1)], atol=1e-9)


def test_the_surfaces_of_an_obstacle_do_not_depend_on_whether_it_moves(arena, moving, robot):
    still, moved = job_of(arena, robot).scene, job_of(moving, robot).scene
    own = {s.name: s for s in still.surfaces if s.name.startswith("obstacle_O2")}
    assert own
    assert own == {s.name: s for s in moved.surfaces if s.name.startswith("obstacle_O2")}


def test_a_job_in_which_nothing_moves_does_not_speak_of_it(arena, robot):
    fields = json.loads(job_of(arena, robot).to_json())
    assert "moving" not in fields["scene"]
    assert all("moving" not in view for view in fields["frames"])


def test_the_room_holds_the_whole_path(moving):
    _, high = arena_bounds(moving)
    assert high[0] == pytest.approx(1.55 + 0.04 * np.sqrt(2))


def test_box_and_shadow_stand_where_the_view_says(light_of):
    """A red cube on a grey floor under a sun at 45 degrees from +x, whose shadow is as long as the cube is high."""
    grey = Surface("grey", Color((0.5, 0.5, 0.5)), roughness=1.0, refractive_index=1.0)
    red = Surface("red", Color((0.5, 0.0, 0.0)), roughness=1.0, refractive_index=1.0)
    scene = Scene(
        surfaces=(grey, red),
        meshes=(floor("floor", (-2.0, -2.0), (2.0, 2.0), 0.0, "grey"),),
        robot=(),
        panels=(),
        sun=Sun((np.sqrt(0.5), 0.0, np.sqrt(0.5)), (SUN,) * 3, np.radians(0.5)),
        sky=Sky("studio", 0.0, 0.0, 10.0, 1.0),
        moving=(block(LONGEST_NAME, (0.0, 0.0, SIZE_M / 2), (SIZE_M,) * 3, "red"),),
    )
    down = ((1.0, 0.0, 0.0, 0.0), (0.0, -1.0, 0.0, 0.0), (0.0, 0.0, -1.0, HEIGHT_M), (0.0, 0.0, 0.0, 1.0))
    places = [(-0.15, -0.1, 0.0), (0.2, 0.15, np.pi / 2)]
    views = [FrameView(i + 1, 0.0, (9.0, 9.0, 0.0), down, (place,)) for i, place in enumerate(places)]
    images = light_of(scene, views, 101, 250.0)
    lit = 0.5 / np.pi * SUN * np.sqrt(0.5)

    def seen(image, x, y, z=0.0):
        scale = 250.0 / (HEIGHT_M - z)
        return image[round(50 - scale * y), round(50 + scale * x)]

    for image, other, (x, y, _) in zip(images, images[::-1], places, strict=True):
        np.testing.assert_allclose(seen(image, x, y, SIZE_M), (lit, 0, 0), rtol=0.05, atol=0.02)
        # From its foot on: 15 mm beside the cube, in the middle, and just before its end; beyond it there is light.
        for beside in (0.015, 0.05, 0.085):
            assert seen(image, x - SIZE_M / 2 - beside, y).max() < 0.3 * lit
            np.testing.assert_allclose(seen(other, x - SIZE_M / 2 - beside, y), lit, rtol=0.1)
        np.testing.assert_allclose(seen(image, x - SIZE_M / 2 - 0.125, y), lit, rtol=0.1)
        np.testing.assert_allclose(seen(other, x, y), lit, rtol=0.1)

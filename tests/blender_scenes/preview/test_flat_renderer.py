"""Full images without Blender."""

from dataclasses import replace

import numpy as np
import pytest

from blender_scenes.preview.renderer import FlatRenderer
from blender_scenes.render.job import FramePose, build_job
from blender_scenes.scene.meshes import block
from configs.schema.appearance.look import CameraLook, LampsLook, LookConfig, SkyLook, SunLook
from configs.schema.scenario import Render
from symolo.arena.obstacle_motion import ObstacleMotion
from symolo.core.geometry.pinhole import project

FRAMES = [FramePose(number=i, t_s=0.5 * i, x_m=0.55, y_m=-0.6, yaw_rad=np.pi / 2) for i in (1, 2)]
SMALL = Render(width_px=64, height_px=48)
EVEN = CameraLook(contrast=1, vignetting=0, shot_noise=0, read_noise=0, exposure_adaption=1, saturation=1)


def job_of(arena, robot, look=None):
    return build_job(arena, robot, look or LookConfig(name="plain", camera=EVEN), SMALL, FRAMES, seed=5)


def test_the_median_of_an_image_is_the_brightness_that_the_look_sets(arena, robot):
    """0.25 of the light is 137 of 255 in sRGB (IEC 61966-2-1)."""
    job = job_of(arena, robot)
    image = FlatRenderer(job).image(job.frames[0])
    assert image.shape == (48, 64, 3)
    grey = image.reshape(-1, 3) @ np.array([0.2126, 0.7152, 0.0722])
    assert np.median(grey) == pytest.approx(137, abs=3)


def test_a_monochrome_camera_meters_what_it_measures(arena, robot):
    """In the light of a red lamp, red counts a third of what it measures and 0.2126 of the luminance."""
    camera = EVEN.model_copy(update={"colour_filter": "monochrome", "exposure_adaption": 0})
    red = {"lamps": LampsLook(color_temperature_K=1500), "sun": SunLook(illuminance_klx=0)}
    look = LookConfig(name="red", camera=camera, sky=SkyLook(luminance_kcd_m2=0), **red)
    job = job_of(arena, robot, look)
    image = FlatRenderer(job).image(job.frames[0])
    assert np.array_equal(image[..., 0], image[..., 2])
    assert np.median(image) == pytest.approx(137, abs=3)


def test_the_line_is_dark_where_the_camera_says_it_is(arena, robot):
    job = job_of(arena, robot)
    light = FlatRenderer(job).light(job.frames[0], job.camera).mean(axis=-1)
    X_WC = np.array(job.frames[0].X_WC)
    on_line, beside = np.array([[0.55, -0.40, 0.0]]), np.array([[0.50, -0.40, 0.0]])
    (column, row), (aside, at) = (np.rint(project(job.camera, X_WC, p)[0][0]).astype(int) for p in (on_line, beside))
    assert light[row, column] < 0.2 * light[at, aside]


def test_a_moving_obstacle_is_seen_where_it_is_at_the_time_of_the_frame(arena, robot):
    path = ObstacleMotion((0.0, 1.0), ((0.35, 0.0, 0.0), (0.75, 0.0, 0.0)), repeats=False)
    *others, last = arena.boxes
    job = job_of(replace(arena, boxes=(*others, replace(last, motion=path))), robot)
    renderer = FlatRenderer(job)
    light = [renderer.light(view, job.camera) for view in job.frames]
    for now, x_m in ((0, 0.55), (1, 0.75)):
        front = np.array([[x_m, -0.04, 0.06]])
        pixel, _ = project(job.camera, np.array(job.frames[now].X_WC), front)
        column, row = np.rint(pixel[0]).astype(int)
        card, other = light[now][row, column], light[1 - now][row, column]
        assert card[0] > 1.2 * card[2]  # brown
        assert np.abs(card - other).max() > 0.1 * card.max()


def test_the_robot_is_not_seen_by_its_own_camera(arena, robot):
    job = job_of(arena, robot)
    in_the_way = block("screen", (0.3, 0.0, 0.1), (0.01, 0.5, 0.5), "robot_plate")
    hidden = replace(job, scene=replace(job.scene, robot=(in_the_way,)))
    view = job.frames[0]
    np.testing.assert_array_equal(FlatRenderer(hidden).image(view), FlatRenderer(job).image(view))


def test_the_same_job_gives_the_same_pixels_and_each_frame_its_own_noise(arena, robot):
    job = job_of(arena, robot, LookConfig(name="noisy"))
    first, second = (FlatRenderer(job).image(job.frames[0]) for _ in range(2))
    np.testing.assert_array_equal(first, second)
    assert not np.array_equal(first, FlatRenderer(job).image(job.frames[1]))


def test_a_scene_without_light_is_refused(arena, robot):
    dark = {"sun": SunLook(illuminance_klx=0), "lamps": LampsLook(flux_klm=0), "sky": SkyLook(luminance_kcd_m2=0)}
    with pytest.raises(ValueError, match="no light reaches"):
        FlatRenderer(job_of(arena, robot, LookConfig(name="dark", **dark)))

"""The measures of `benchmarks/render/errors/temporal_flicker.py`, on surfaces and errors in closed form."""

import importlib
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.render.references.views import Views, random_cases
from blender_scenes.render.job import RenderJob
from blender_scenes.render.sampling import TracingSettings
from blender_scenes.scene.description import Scene, Sky
from blender_scenes.scene.meshes import rectangle
from blender_scenes.scene.shading import Color, Surface
from configs.schema.appearance.look import CameraLook
from sensors.camera.response import CameraResponse
from sensors.camera.views import FrameView
from symolo.core.geometry.pinhole import Intrinsics

CAMERA = Intrinsics(32, 24, 40.0, 40.0, 15.5, 11.5)
AWAY_M = 2.0
STEP_M = 2 * AWAY_M / CAMERA.fx_px
"""Step along x that moves a surface at that distance by 2 px to the left."""
FAR = np.full((24, 32), AWAY_M)


@pytest.fixture
def flicker():
    return importlib.import_module("benchmarks.render.errors.temporal_flicker")


def _pose(x_m: float) -> np.ndarray:
    pose = np.eye(4)
    pose[0, 3] = x_m
    return pose


def test_a_pixel_comes_from_where_its_surface_was(flicker):
    columns, rows, known = flicker.reprojected(CAMERA, (_pose(0.0), FAR), (_pose(STEP_M), FAR))
    v, u = np.indices(FAR.shape)
    assert columns == pytest.approx(u + 2, abs=1e-4)
    assert rows == pytest.approx(v, abs=1e-4)
    assert (known == (u < 30)).all()


def test_what_something_nearer_hid_before_is_not_known(flicker):
    before = FAR.copy()
    before[:, 10:14] = 1.0
    _, _, known = flicker.reprojected(CAMERA, (_pose(0.0), before), (_pose(STEP_M), FAR))
    hidden = np.zeros_like(known)
    hidden[:, 8:12] = True
    assert (known == (~hidden & (np.indices(FAR.shape)[1] < 30))).all()


def _views() -> Views:
    """Two images of one pose and one from a step further on, of an endless wall across the view."""
    corners = [(x, y, AWAY_M) for x, y in ((-9.0, -9.0), (-9.0, 9.0), (9.0, 9.0), (9.0, -9.0))]
    scene = Scene(
        surfaces=(Surface("grey", Color((0.5,) * 3)),),
        meshes=(rectangle("wall", corners, "grey"),),
        robot=(),
        panels=(),
        sun=None,
        sky=Sky("studio", 0.0, 0.2, 10.0, 1.0),
    )
    poses = [tuple(map(tuple, _pose(x_m).tolist())) for x_m in (0.0, 0.0, STEP_M)]
    views = tuple(FrameView(i + 1, 0.0, (0.0, 0.0, 0.0), pose) for i, pose in enumerate(poses))
    response = CameraResponse.from_look(CameraLook(), (1.0, 1.0, 1.0), 1, 92)
    response = replace(response, shot_noise=0.0, read_noise=0.0)
    job = RenderJob(RenderJob.FORMAT, scene, CAMERA, views, TracingSettings(1, 1, denoise=False), response)
    return Views("a wall", job, 0.0, 0.0)


def _lights(*patterns: np.ndarray) -> dict[int, np.ndarray]:
    return {i + 1: np.repeat(pattern[..., None], 3, axis=-1).astype(np.float32) for i, pattern in enumerate(patterns)}


EVEN = np.ones((24, 32))
V, U = np.indices(EVEN.shape)
WAVES = 0.02 * np.sin(2 * np.pi * U / 16)
"""An error; 2 px are an eighth of its length."""


def test_images_that_are_equal_do_not_flicker(flicker):
    pair = {number: (np.ones((24, 32, 3), np.float32),) * 2 for number in (2, 3)}
    measured = flicker.flicker(_views(), _lights(EVEN, EVEN, EVEN), pair, 1.0)
    assert (measured.still, measured.worst_still, measured.moving) == (0.0, 0.0, pytest.approx(0.0, abs=1e-4))


def test_a_still_camera_sees_every_difference(flicker):
    """The worst square of eight pixels is all inside the patch that differs."""
    pair = {number: (np.ones((24, 32, 3), np.float32),) * 2 for number in (2, 3)}
    patch = EVEN + 0.05 * ((U >= 8) & (U < 24) & (V >= 4) & (V < 20))
    measured = flicker.flicker(_views(), _lights(EVEN, patch, patch), pair, 1.0)
    assert measured.worst_still > 1.0
    assert measured.still == pytest.approx(measured.worst_still * np.sqrt(16 * 16 / (24 * 32)), rel=0.05)


def test_an_error_that_stays_on_its_surface_does_not_flicker_and_one_that_stays_in_the_image_does(flicker):
    """The difference of two sines an eighth of a period apart has 2 sin(pi / 8) times the amplitude."""
    pair = {number: (np.ones((24, 32, 3), np.float32),) * 2 for number in (2, 3)}
    on_surface = _lights(EVEN, EVEN + WAVES, EVEN + 0.02 * np.sin(2 * np.pi * (U + 2) / 16))
    in_image = _lights(EVEN, EVEN + WAVES, EVEN + WAVES)
    one_image = _lights(EVEN, EVEN, EVEN + WAVES)
    carried, stays, alone = (
        flicker.flicker(_views(), light, pair, 1.0).moving for light in (on_surface, in_image, one_image)
    )
    assert carried < 0.1 * stays
    assert stays == pytest.approx(2 * np.sin(np.pi / 8) * alone, rel=0.1)


def test_noise_of_the_references_cancels(flicker):
    random = np.random.default_rng(3)
    noisy = {
        number: tuple(np.float32(1 + 0.1 * random.standard_normal((24, 32, 3))) for _ in range(2)) for number in (2, 3)
    }
    measured = flicker.flicker(_views(), _lights(EVEN, EVEN, EVEN), noisy, 1.0)
    assert measured.moving < 3 * measured.moving_error
    assert measured.moving_error > 0


def test_each_place_has_two_images_of_one_pose_and_a_step_at_the_same_time():
    (case,) = random_cases(["garage"], 0, 5)
    frames = case.repeated_views(2, (64, 48)).job.frames
    assert [frame.number for frame in frames] == [1, 2, 3, 4, 5, 6]
    assert {frame.t_s for frame in frames} == {0.0}
    for first, again, moved in (frames[:3], frames[3:]):
        assert first.X_WC == again.X_WC
        (x, y, yaw), (there_x, there_y, there_yaw) = again.robot_pose, moved.robot_pose
        assert np.hypot(there_x - x, there_y - y) == pytest.approx(0.032)
        assert np.degrees(there_yaw - yaw) == pytest.approx(3.0)

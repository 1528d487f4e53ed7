"""Joints finer than a pixel, and the edges of the line, in hybrid images: even and in their places all along them."""

import numpy as np
import pytest

from blender_scenes.render.job import RenderJob
from blender_scenes.render.sampling import HYBRID_QUALITIES, TracingSettings
from blender_scenes.scene.description import LightPanel, Scene, Sky
from blender_scenes.scene.meshes import floor, rectangle
from blender_scenes.scene.shading import Color, Mix, Surface, Tiles
from configs.schema.appearance.look import CameraLook
from configs.schema.robot import Camera
from sensors.camera.response import CameraResponse
from sensors.camera.views import FrameView
from symolo.core.geometry.pinhole import Intrinsics, floor_points, pose_X_RC
from symolo.core.geometry.poses import pose_X_WR

CAMERA = Intrinsics(96, 48, 110.0, 110.0, 47.5, 23.5)
MOUNTED = Camera(
    x_m=0.05, y_m=0.0, height_above_base_m=0.25, pitch_down_deg=50.0, focal_length_mm=4.0, sensor_width_mm=5.7
)
X_WC = pose_X_WR(0.0, 0.0, 0.0) @ pose_X_RC(MOUNTED, base_height_m=0.0)
JOINT_M, SOFTNESS = 0.001, 0.5
WIDTH_M = JOINT_M * (1 - 0.5 * SOFTNESS)
"""Width of a black joint with hard edges that is as dark; a pixel sees 3 mm of the floor."""
JOINTS_M = (-0.06, 0.0, 0.06)
"""Places of the joints, which lie along the view, across it."""
TAPE_M = (0.089, 0.105)
"""Right and left edge of a tape along the view."""
LIGHT = LightPanel("sky", (0.0, 0.0, 3.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), 30.0, 30.0, (1.0, 1.0, 1.0), seen=False)


@pytest.fixture(scope="module")
def image(lights_of) -> np.ndarray:
    """(H, W): white planks with black joints and a black tape in even light."""
    joint = Tiles((9.0, 0.06), JOINT_M, 0.0, (4.5, 0.0), "joint", softness=SOFTNESS)
    planks = Surface("floor", Mix(joint, Color((0.5,) * 3), Color((0.0,) * 3)), roughness=1.0, refractive_index=1.0)
    black = Surface("black", Color((0.0,) * 3), roughness=1.0, refractive_index=1.0)
    tape = [(x, y, 0.0001) for x, y in zip((-1.0, 1.0, 1.0, -1.0), np.repeat(TAPE_M, 2).tolist(), strict=True)]
    scene = Scene(
        surfaces=(planks, black),
        meshes=(floor("floor", (-1.2, -1.2), (1.2, 1.2), 0.0, "floor"), rectangle("tape_0", tape, "black")),
        robot=(),
        panels=(LIGHT,),
        sun=None,
        sky=Sky("studio", 0.0, 0.2, 10.0, 1.0),
    )
    view = FrameView(1, 0.0, (0.0, 0.0, 0.0), tuple(tuple(row) for row in X_WC.tolist()))
    response = CameraResponse.from_look(CameraLook(), (1.0, 1.0, 1.0), 1, 92)
    sampling = TracingSettings(1, 1, denoise=False, hybrid=HYBRID_QUALITIES["standard"])
    job = RenderJob(RenderJob.FORMAT, scene, CAMERA, (view,), sampling, response)
    (light,) = lights_of((job, 1, [1]), coarser=4)
    return light[0].mean(axis=-1)


@pytest.fixture(scope="module")
def floor_m(image) -> tuple[np.ndarray, np.ndarray]:
    """(H, W): the place of the floor in each pixel across the view, and how much of it is black in a row, both [m]."""
    height, width = image.shape
    pixels = np.column_stack([axis.ravel() for axis in np.indices((height, width))[::-1]]).astype(float)
    across_m = floor_points(CAMERA, X_WC, pixels)[:, 1].reshape(height, width)
    pixel_m = np.abs(np.diff(across_m, axis=1)).mean(axis=1, keepdims=True)
    return across_m, (1 - image / np.median(image, axis=1, keepdims=True)) * pixel_m


def test_a_joint_finer_than_a_pixel_is_as_dark_as_its_width_says_all_along_it(floor_m):
    """Neither does it vanish in places, nor does it change from image to image, which show it at other pixels."""
    across_m, dark_m = floor_m
    for at_m in JOINTS_M:
        widths_m = (dark_m * (np.abs(across_m - at_m) < 0.02)).sum(axis=1)
        assert widths_m.mean() == pytest.approx(WIDTH_M, rel=0.1)
        assert widths_m.std() < 0.15 * WIDTH_M


def test_the_edges_of_a_tape_are_straight(floor_m):
    """The width of a tape in a row is the sum of its dark pixels, and its middle is their mean place."""
    across_m, dark_m = floor_m
    dark_m = dark_m * (np.abs(across_m - np.mean(TAPE_M)) < 0.016)
    widths_m = dark_m.sum(axis=1)
    middles_m = (dark_m * across_m).sum(axis=1) / widths_m
    for side, edge_m in zip((-0.5, 0.5), TAPE_M, strict=True):
        off_px = (middles_m + side * widths_m - edge_m) / np.abs(np.diff(across_m, axis=1)).mean(axis=1)
        assert off_px.mean() == pytest.approx(0.0, abs=0.05)
        assert off_px.std() < 0.05

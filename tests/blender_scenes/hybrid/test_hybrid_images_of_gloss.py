"""Gloss of tiles and their joints in hybrid images, against a full image of many samples."""

from dataclasses import replace

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
from symolo.core.geometry.pinhole import Intrinsics, pose_X_RC
from symolo.core.geometry.poses import pose_X_WR

CAMERA = Intrinsics(80, 40, 110.0, 110.0, 39.5, 15.5)
NEAR_WIDTH_PX = 40
"""Width of the light image: four of the image's pixels share one of its pixels."""
MOUNTED = Camera(
    x_m=0.05, y_m=0.0, height_above_base_m=0.07, pitch_down_deg=25.0, focal_length_mm=4.0, sensor_width_mm=5.7
)
X_WC = pose_X_WR(0.0, 0.0, 0.0) @ pose_X_RC(MOUNTED, base_height_m=0.0)
JOINT = Tiles((9.0, 0.06), 0.004, 0.0, (4.5, 0.0), "joint", softness=0.3)
"""Joints along the view."""
TILES = Surface(
    "floor",
    Mix(JOINT, Color((0.6, 0.6, 0.6)), Color((0.3, 0.3, 0.3))),
    roughness=JOINT * 0.65 + 0.25,
    refractive_index=1.5,
)
GREY = Surface("grey", Color((0.7, 0.7, 0.7)), roughness=1.0, refractive_index=1.0)
WALL = rectangle("wall", [(1.2, 1.2, 0.0), (1.2, -1.2, 0.0), (1.2, -1.2, 2.0), (1.2, 1.2, 2.0)], "grey")
LAMP = LightPanel("lamp", (0.5, 0.0, 2.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), 1.2, 0.3, (20.0, 20.0, 20.0))
MIRRORED = LightPanel("mirrored", (0.83, 0.0, 0.27), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), 0.68, 0.9, (5.0, 5.0, 5.0))
"""A lamp whose mirror image covers all of the floor in sight, so that gloss is half of the light of a tile, but little
of that of a joint, whose roughness spreads it."""
NEAR_SAMPLES = 64
"""Light paths per pixel of the light image, so many that the random numbers hardly change how strong the joints are."""


@pytest.fixture(scope="module")
def images(lights_of) -> list[np.ndarray]:
    """(H, W) light of a hybrid and of a full image."""
    scene = Scene(
        surfaces=(TILES, GREY),
        meshes=(floor("floor", (-1.2, -1.2), (1.2, 1.2), 0.0, "floor"), WALL),
        robot=(),
        panels=(LAMP, MIRRORED),
        sun=None,
        sky=Sky("studio", 0.0, 0.2, 10.0, 0.2),
    )
    view = FrameView(1, 0.0, (0.0, 0.0, 0.0), tuple(tuple(row) for row in X_WC.tolist()))
    response = CameraResponse.from_look(CameraLook(), (1.0, 1.0, 1.0), 1, 92)
    samples = replace(HYBRID_QUALITIES["standard"], near=NEAR_SAMPLES)
    hybrid = TracingSettings(1, 1, denoise=False, hybrid=samples)
    full = replace(hybrid, samples=256, hybrid=None)
    jobs = (RenderJob(RenderJob.FORMAT, scene, CAMERA, (view,), sampling, response) for sampling in (hybrid, full))
    lights = lights_of(*((job, 1, [1]) for job in jobs), near_width_px=NEAR_WIDTH_PX, coarser=4)
    return [light[0].mean(axis=-1) for light in lights]


def test_the_floor_with_its_gloss_is_as_bright_as_in_a_full_image(images):
    hybrid, full = images
    assert hybrid.mean() == pytest.approx(full.mean(), rel=0.03)


def _contrast(image: np.ndarray) -> float:
    """Return the standard deviation along the rows, relative to their mean."""
    rows = image / image.mean(axis=1, keepdims=True)
    return float(rows.std(axis=1).mean())


def test_joints_of_glossy_tiles_are_as_strong_as_in_a_full_image(images):
    """Gloss that does not follow the roughness would make them a fifth weaker, so half of that is too much."""
    hybrid, full = (_contrast(image) for image in images)
    assert hybrid == pytest.approx(full, rel=0.1)

"""Edges between a thing and the floor behind it: a pixel there is a mixture of both, so it is no brighter than both."""

from dataclasses import replace

import numpy as np
import pytest

from blender_scenes.render.job import RenderJob
from blender_scenes.render.sampling import HYBRID_QUALITIES, TracingSettings
from blender_scenes.scene.description import LightPanel, Mesh, Scene, Sky, Sun
from blender_scenes.scene.meshes import block, floor
from blender_scenes.scene.shading import Color, Surface
from configs.schema.appearance.look import CameraLook
from configs.schema.robot import Camera
from sensors.camera.response import CameraResponse
from sensors.camera.views import FrameView
from symolo.core.geometry.pinhole import Intrinsics, pose_X_RC, project
from symolo.core.geometry.poses import pose_X_WR

SMALL = Intrinsics(64, 48, 60.0, 60.0, 31.5, 23.5)
"""Its light images have as many pixels."""
WIDE = Intrinsics(640, 32, 600.0, 600.0, 319.5, 236.0)
"""The light images of its upper rows have half as many pixels each way."""
MOUNTED = Camera(
    x_m=0.05, y_m=0.0, height_above_base_m=0.25, pitch_down_deg=25.0, focal_length_mm=4.0, sensor_width_mm=5.7
)
X_WC = pose_X_WR(0.0, 0.0, 0.0) @ pose_X_RC(MOUNTED, base_height_m=0.0)
SUN = Sun((0.48, -0.6, 0.64), (20.0,) * 3, 0.009)
"""It shines from behind the box and from the right, so that the face before the camera is in the shade."""
BOX_AT_M, BOX_M = 0.7, (0.1, 0.161, 0.4)
BOX = block("wall_A", (BOX_AT_M, 0.0, 0.5 * BOX_M[2]), BOX_M, "white")
SHEET_AT_M, SHEET_M = 1.1, (0.3, 0.22, 0.0004)
SHEET = block("papers_0", (SHEET_AT_M, 0.0, 0.5 * SHEET_M[2]), SHEET_M, "white")
"""A sheet of paper as `rooms.furniture.sheets` has it."""
PANEL = LightPanel("sky", (0.0, 0.0, 3.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), 30.0, 30.0, (1.0,) * 3, seen=False)
TOLERANCE = 0.05
"""Share by which noise may make a pixel brighter or darker."""
LIT_ROW = 18
"""First row that shows the floor but not its end."""


def _job(camera: Intrinsics, thing: Mesh, sun: Sun | None, panels: tuple[LightPanel, ...]) -> RenderJob:
    surfaces = [
        Surface(name, Color((reflectance,) * 3), roughness=1.0, refractive_index=1.0)
        for name, reflectance in (("floor", 0.3), ("white", 0.7))
    ]
    scene = Scene(
        surfaces=tuple(surfaces),
        meshes=(floor("floor", (-2.0, -3.0), (5.0, 3.0), 0.0, "floor"), thing),
        robot=(),
        panels=panels,
        sun=sun,
        sky=Sky("studio", 0.0, 0.2, 10.0, 1.0),
    )
    view = FrameView(1, 0.0, (0.0, 0.0, 0.0), tuple(tuple(row) for row in X_WC.tolist()))
    response = CameraResponse.from_look(CameraLook(), (1.0, 1.0, 1.0), 1, 92)
    sampling = TracingSettings(1, 1, denoise=False, hybrid=HYBRID_QUALITIES["standard"])
    return RenderJob(RenderJob.FORMAT, scene, camera, (view,), sampling, response)


@pytest.fixture(scope="module")
def images(lights_of) -> dict[str, np.ndarray]:
    """(H, W): the shaded face of a box in two sizes, and a sheet of paper on the floor in even light."""
    jobs = {
        "box": _job(SMALL, BOX, SUN, ()),
        "large box": _job(WIDE, BOX, SUN, ()),
        "sheet": _job(replace(SMALL, cy_px=35.5), SHEET, None, (PANEL,)),
    }
    lights = lights_of(*((job, 1, [1]) for job in jobs.values()), coarser=4)
    return {name: light[0].mean(axis=-1) for name, light in zip(jobs, lights, strict=True)}


@pytest.mark.parametrize(("name", "camera"), [("box", SMALL), ("large box", WIDE)])
def test_a_pixel_at_the_side_of_a_shaded_face_is_no_brighter_than_the_floor_behind_it(images, name, camera):
    right = np.array([(BOX_AT_M - 0.5 * BOX_M[0], -0.5 * BOX_M[1], 0.2)])
    edge = round(float(project(camera, X_WC, right)[0][0, 0]))
    rows = slice(camera.height_px // 6, camera.height_px // 3)
    face, lit = images[name][rows, edge - 8 : edge - 3], images[name][rows, edge + 4 : edge + 9]
    assert face.max() < 0.7 * lit.min()
    across = images[name][rows, edge - 3 : edge + 4]
    assert (across <= (1 + TOLERANCE) * lit.max(axis=1, keepdims=True)).all()


def test_the_edges_of_a_sheet_on_the_floor_are_between_floor_and_sheet(images):
    """No dark pixels: the floor below the sheet, which no light reaches, does not count as floor beside it."""
    image = images["sheet"]
    bright, dark = np.quantile(image, 0.995), np.median(image)
    assert bright == pytest.approx(0.7 / 0.3 * dark, rel=0.05)
    assert image[LIT_ROW:].min() > 0.9 * dark
    assert image.max() < (1 + TOLERANCE) * bright

"""Fisheye lenses in Cycles' light: edges of black boards around the camera, beside it and behind it."""

import numpy as np
import pytest

from blender_scenes.render.job import RenderJob
from blender_scenes.render.sampling import TracingSettings
from blender_scenes.scene.description import Scene, Sky
from blender_scenes.scene.meshes import block
from blender_scenes.scene.shading import Color, Surface
from configs.schema.appearance.look import CameraLook
from sensors.camera.response import CameraResponse
from sensors.camera.views import INSTANT, FrameView
from symolo.core.geometry.fisheye import Fisheye
from symolo.core.geometry.pinhole import Intrinsics, project

WIDTH_PX, HEIGHT_PX = 161, 9
X_WC = ((0.0, 0.0, 1.0, 0.0), (-1.0, 0.0, 0.0, 0.0), (0.0, -1.0, 0.0, 2.0), (0.0, 0.0, 0.0, 1.0))
"""Level, along x, 2 m above the origin."""
HALF_FIELD_RAD = np.radians(115.0)
LENSES = {
    "equidistant": Intrinsics(
        WIDTH_PX, HEIGHT_PX, 80 / HALF_FIELD_RAD, 80 / HALF_FIELD_RAD, 80.0, 4.0, fisheye=Fisheye(HALF_FIELD_RAD)
    ),
    "bent and off the middle": Intrinsics(
        WIDTH_PX, HEIGHT_PX, 37.0, 37.0, 83.0, 4.5, fisheye=Fisheye(HALF_FIELD_RAD, (0.03, -0.01, 0.001, 0.0))
    ),
}
EDGES = {
    "ahead, its left edge": (1.0, 0.35),
    "ahead, its right edge": (1.0, -0.25),
    "to the left, its front edge": (0.3, 1.0),
    "to the left, its rear edge": (-0.2, 1.0),
    "to the right, its rear edge": (-0.2, -1.0),
}
"""x, y [m] of the vertical edges; those at a negative x are more than 90 degrees from the axis."""


@pytest.fixture(scope="module")
def images(lights_of) -> dict[str, np.ndarray]:
    black = Surface("black", Color((0.0, 0.0, 0.0)), roughness=1.0, refractive_index=1.0)
    boards = (
        block("ahead", (1.0, 0.05, 2.0), (0.001, 0.6, 4.0), "black"),
        block("left", (0.05, 1.0, 2.0), (0.5, 0.001, 4.0), "black"),
        block("right", (0.1, -1.0, 2.0), (0.6, 0.001, 4.0), "black"),
    )
    sky = Sky("studio", 0.0, 1000.0, 0.001, 0.0)  # all of the panorama is brighter than its limit, so that it is even
    scene = Scene(surfaces=(black,), meshes=boards, robot=(), panels=(), sun=None, sky=sky)
    response = CameraResponse.from_look(CameraLook(), (1.0, 1.0, 1.0), 1, 92)
    view, sampling = FrameView(1, 0.0, (9.0, 9.0, 0.0), X_WC), TracingSettings(seed=1, samples=64, denoise=False)
    jobs = [
        RenderJob(RenderJob.FORMAT, scene, camera, (view,), sampling, response, INSTANT) for camera in LENSES.values()
    ]
    lights = lights_of(*((job, 1, None) for job in jobs))
    return {name: light[0] for name, light in zip(LENSES, lights, strict=True)}


@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize("edge", EDGES)
def test_edges_beside_and_behind_the_camera_are_seen_where_the_model_projects_them(images, lens, edge):
    camera, light = LENSES[lens], images[lens][..., 1]
    (at,), _ = project(camera, np.array(X_WC), np.array([[*EDGES[edge], 2.0]]))
    row = light[round(camera.cy_px)]
    first = round(at[0]) - 4
    profile = row[first : first + 9]
    step = (profile - profile[0]) / (profile[-1] - profile[0])
    assert first + 8.5 - step.sum() == pytest.approx(at[0], abs=0.15)


def test_there_is_no_light_beyond_the_field_of_view(images):
    camera = LENSES["bent and off the middle"]
    reach_px = camera.fx_px * float(camera.fisheye.radius(np.array(HALF_FIELD_RAD)))
    row = images["bent and off the middle"][4, :, 1]
    dark = np.abs(np.arange(WIDTH_PX) - camera.cx_px) > reach_px + 1
    assert dark.any()
    assert (row[dark] == 0.0).all()

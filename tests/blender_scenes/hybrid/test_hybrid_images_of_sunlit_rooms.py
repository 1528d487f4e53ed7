"""Light from sunlit walls on a floor in the shade: maps against full images."""

import numpy as np
import pytest

from blender_scenes.render.job import RenderJob
from blender_scenes.render.sampling import HYBRID_QUALITIES, TracingSettings
from blender_scenes.scene.description import Scene, Sky, Sun
from blender_scenes.scene.meshes import block, floor
from blender_scenes.scene.shading import Color, Surface
from configs.schema.appearance.look import CameraLook
from configs.schema.robot import Camera
from sensors.camera.response import CameraResponse
from sensors.camera.views import FrameView
from symolo.core.geometry.pinhole import Intrinsics, pose_X_RC
from symolo.core.geometry.poses import pose_X_WR

CAMERA = Intrinsics(64, 48, 45.0, 45.0, 31.5, 23.5)
ELEVATION = np.radians(25.0)
MOUNTED = Camera(
    x_m=0.05, y_m=0.0, height_above_base_m=0.25, pitch_down_deg=35.0, focal_length_mm=4.0, sensor_width_mm=5.7
)
X_RC = pose_X_RC(MOUNTED, base_height_m=0.0)
SUN_klx = 10.0
WALL = block("wall_A", (1.2, 0.0, 0.4), (0.05, 2.0, 0.8), "white")
BLIND = block("wall_B", (-0.6, 0.0, 0.15), (0.05, 2.0, 0.3), "white")
"""Its shadow lies on all of the floor in sight, the sun on the upper part of the wall."""


def _matt(name: str, reflectance: float) -> Surface:
    return Surface(name, Color((reflectance,) * 3), roughness=1.0, refractive_index=1.0)


@pytest.fixture(scope="module")
def images(lights_of) -> tuple[np.ndarray, np.ndarray]:
    """(H, W, 3) from hybrid rendering, and in full."""
    scene = Scene(
        surfaces=(_matt("floor", 0.3), _matt("white", 0.7)),
        meshes=(floor("floor", (-2.0, -2.0), (2.0, 2.0), 0.0, "floor"), WALL, BLIND),
        robot=(),
        panels=(),
        sun=Sun((-float(np.cos(ELEVATION)), 0.0, float(np.sin(ELEVATION))), (SUN_klx,) * 3, 0.009),
        sky=Sky("studio", 0.0, 0.2, 10.0, 1.0),
    )
    rows = tuple(tuple(row) for row in (pose_X_WR(0.0, 0.0, 0.0) @ X_RC).tolist())
    response = CameraResponse.from_look(CameraLook(), (1.0, 1.0, 1.0), 1, 92)
    views = (FrameView(1, 0.0, (0.0, 0.0, 0.0), rows),)
    jobs = [
        RenderJob(
            RenderJob.FORMAT, scene, CAMERA, views, TracingSettings(1, 256, denoise=False, hybrid=hybrid), response
        )
        for hybrid in (HYBRID_QUALITIES["standard"], None)
    ]
    (hybrid,), (full,) = lights_of(*((job, 1, [1]) for job in jobs))
    return hybrid, full


@pytest.mark.parametrize("rows", [slice(14, 20), slice(30, 46)], ids=["far", "near"])
def test_the_floor_in_the_shade_has_the_light_of_a_sunlit_wall(images, rows):
    """The limit on the light of a path must not act on the map's white floor where it does not on the grey one."""
    hybrid, full = (image[rows, 4:24].mean() for image in images)
    assert hybrid == pytest.approx(full, rel=0.03)

"""Cases of an independent generator of images."""

import importlib
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from configs.schema.appearance.look import LookConfig
from configs.schema.arena import ArenaConfig
from diagnosis.camera.case import CameraCase, CameraFrame
from sensors.camera.response import CameraResponse
from symolo.arena.geometry import Arena
from symolo.core.geometry.robot_path import RobotPath

TESTS = Path(__file__).parents[2]
SIZE, FRAMES = (128, 96), 10


@pytest.fixture(scope="session")
def generator():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(TESTS))
        yield importlib.import_module("camera_cases")


@pytest.fixture(scope="session")
def make_case(generator):
    """A case of a camera that is not the nominal one; with simulated images of the nominal one if asked for."""
    times = np.linspace(0.3, 7.4, FRAMES).tolist()
    rows = np.arange(0.0, 8.0, 0.01)

    @cache
    def simulated(t_s):
        return generator.image(generator.Camera(), t_s, SIZE, seed=2)

    def made(camera=None, hidden=None, *, compared=False):
        camera = camera or generator.Camera()
        frames = tuple(
            CameraFrame(
                number=k + 1,
                t_s=t_s,
                image=generator.image(camera, t_s, SIZE, hidden, seed=1),
                simulated=simulated(t_s) if compared else None,
                heldout=k % 4 == 3,
            )
            for k, t_s in enumerate(times)
        )
        way = generator.poses(rows)
        robot, _ = draw_robot(load_section("robot", "nominal"), 1, "test")
        response = CameraResponse(
            seed=1,
            brightness=0.2,
            exposure_adaption=0.0,
            white_balance=(1.0, 1.0, 1.0),
            contrast=1.0,
            saturation=1.0,
            vignetting=0.2,
            shot_noise=0.012,
            read_noise=0.003,
            jpeg_quality=92,
            lens_blur_px=0.0,
            veiling_glare=0.0,
            sharpening=0.0,
            sharpening_radius_px=1.0,
        )
        arena = Arena.from_config(ArenaConfig.model_validate(generator.track_yaml()))
        path = RobotPath(rows, way[:, :3], way[:, 3:])
        return CameraCase("made", frames, path, arena, robot, LookConfig(name="made"), response)

    return made

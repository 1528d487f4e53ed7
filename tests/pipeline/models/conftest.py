"""Model files of a robot whose effects and camera leave nothing in its plain place, in the arena of the paper."""

from pathlib import Path

import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.models.files import model_files

SETTINGS = (
    "robot=worn",
    "robot.camera.yaw_left_deg=10",
    "robot.camera.roll_deg=-4",
    "robot.camera.distortion.k1=-0.1",
    "robot.camera.principal_point_right_mm=1.5",
    "robot.tof.mounts.left.pitch_up_deg=7",
    "render.width_px=64",
    "render.height_px=48",
)


@pytest.fixture(scope="session")
def spec():
    return draw_run(load_scenario("symolo", SETTINGS), "CW", 1)


@pytest.fixture(scope="session")
def models(spec, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("models")
    for name, data in model_files(spec, ("urdf", "sdf")).items():
        (folder / name).write_bytes(data)
    return folder

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from blender_scenes.render.job import FramePose, RenderJob, build_job
from configs.schema.appearance.look import CameraLook, LookConfig
from configs.schema.scenario import Render
from symolo.core.geometry.robot_path import RobotPath

FRAMES = [FramePose(number=i, t_s=0.2 * i, x_m=0.55, y_m=-0.6 + 0.03 * i, yaw_rad=np.pi / 2) for i in range(1, 4)]


@pytest.fixture(scope="module")
def job(arena, robot) -> RenderJob:
    return build_job(arena, robot, LookConfig(name="plain"), Render(), FRAMES, seed=5)


def test_a_job_survives_its_file_to_the_byte(job):
    text = job.to_json()
    assert RenderJob.from_json(text) == job
    assert RenderJob.from_json(text).to_json() == text


def test_the_same_run_makes_the_same_bytes_and_another_seed_other_ones(job, arena, robot):
    again = build_job(arena, robot, LookConfig(name="plain"), Render(), FRAMES, seed=5)
    other = build_job(arena, robot, LookConfig(name="plain"), Render(), FRAMES, seed=6)
    assert again.to_json() == job.to_json() != other.to_json()


def test_the_camera_of_each_frame_stands_where_the_robot_carries_it(job):
    for frame, view in zip(FRAMES, job.frames, strict=True):
        X_WC = np.array(view.X_WC)
        assert view.number == frame.number
        assert X_WC[:3, 3] == pytest.approx([0.55, frame.y_m + 0.05, 0.12])
        assert X_WC[:3, 2] == pytest.approx([0, np.cos(np.radians(30)), -0.5], abs=1e-12)


def test_a_job_of_another_format_is_refused(job):
    with pytest.raises(ValueError, match="format 99, expected"):
        RenderJob.from_json(replace(job, format=99).to_json())


def test_a_damaged_job_is_refused(job):
    with pytest.raises(ValueError, match="invalid"):
        RenderJob.from_json(job.to_json()[:-40])
    fields = json.loads(job.to_json())
    del fields["camera"]["fx_px"]
    with pytest.raises(ValueError, match="fx_px"):
        RenderJob.from_json(json.dumps(fields))


def test_importing_the_stage_loads_neither_blender_nor_pybullet():
    program = (
        "import sys, blender_scenes.render.job, blender_scenes.render.renderer, symolo.core.geometry.pinhole\n"
        "print([name for name in ('bpy', 'pybullet', 'blender_scenes.blender_side') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_an_instant_says_nothing_of_an_exposure_and_an_exposure_needs_a_path(job, arena, robot):
    assert all("exposure" not in view for view in json.loads(job.to_json())["frames"])
    look = LookConfig(name="plain", camera=CameraLook(exposure_time_s=0.01))
    with pytest.raises(ValueError, match="path of the robot"):
        build_job(arena, robot, look, Render(), FRAMES, seed=5)
    rows = np.array([[f.x_m, f.y_m, f.yaw_rad] for f in FRAMES])
    path = RobotPath(np.array([f.t_s for f in FRAMES]), rows, np.tile([0.15, 0.0], (3, 1)))
    exposed = build_job(arena, robot, look, Render(), FRAMES, seed=5, path=path)
    assert RenderJob.from_json(exposed.to_json()) == exposed
    for view in exposed.frames:
        y = [moment.X_WC[1][3] for moment in view.exposure]
        assert y[-1] - y[0] == pytest.approx(0.15 * 0.01)
        assert y[2] == pytest.approx(view.X_WC[1][3])

"""Cycles' light against closed forms, and the exposure of the shipped looks."""

import json
import subprocess
import sys

import cv2
import numpy as np
import pytest

from blender_scenes.camera_response import CameraResponse
from blender_scenes.description import FrameView, Intrinsics, Panel, Scene, Sky, Sun
from blender_scenes.geometry import floor
from blender_scenes.job import FramePose, RenderJob, Sampling, build_job
from blender_scenes.renderer import render_job
from blender_scenes.shading import Color, Surface
from configs.draw import draw_look
from configs.loader import load_section
from configs.schema.look import CameraLook
from configs.schema.scenario import Render

_PROGRAM = """
import json, os, sys, tempfile
from pathlib import Path
out = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)
from blender_scenes.bpy_side import build, engine
from blender_scenes.job import RenderJob
job = RenderJob.from_json(sys.stdin.read())
build.start()
build.build(job.scene, job.camera)
with tempfile.TemporaryDirectory() as scratch:
    engine.configure(job, 1, Path(scratch))
    light = engine.frame_light(job, job.frames[0])
out.write(json.dumps(light[light.shape[0] // 2, light.shape[1] // 2].tolist()))
out.flush()
"""


def _seen_below(panels=(), sun=None) -> np.ndarray:
    """Radiance of a grey floor at the origin, looked at from 0.5 m above."""
    surface = Surface("grey", Color((0.5, 0.5, 0.5)), roughness=1.0, refractive_index=1.0)
    scene = Scene(
        surfaces=(surface,),
        meshes=(floor("floor", (-1.0, -1.0), (1.0, 1.0), 0.0, "grey"),),
        robot=(),
        panels=tuple(panels),
        sun=sun,
        sky=Sky("studio", 0.0, 0.0, 10.0, 1.0),
    )
    looking_down = ((1.0, 0.0, 0.0, 0.0), (0.0, -1.0, 0.0, 0.0), (0.0, 0.0, -1.0, 0.5), (0.0, 0.0, 0.0, 1.0))
    job = RenderJob(
        format=1,
        scene=scene,
        camera=Intrinsics(5, 5, 100.0, 100.0, 2.0, 2.0),
        frames=(FrameView(1, 0.0, (5.0, 5.0, 0.0), looking_down),),
        sampling=Sampling(seed=1, samples=512, denoise=False),
        response=CameraResponse.from_look(CameraLook(), (1.0, 1.0, 1.0), 1, 92),
    )
    program = [sys.executable, "-c", _PROGRAM]
    done = subprocess.run(program, input=job.to_json(), capture_output=True, text=True, check=True)
    return np.array(json.loads(done.stdout))


def test_a_lamp_lights_the_floor_as_the_inverse_square_says():
    lamp = Panel("lamp", (0.0, 0.0, 2.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), 0.1, 0.2, (8.0, 4.0, 2.0))
    illuminance = np.array(lamp.radiance) * 0.1 * 0.2 / 2.0**2
    assert _seen_below([lamp]) == pytest.approx(0.5 / np.pi * illuminance, rel=0.02)


def test_the_sun_lights_the_floor_by_the_sine_of_its_elevation():
    sun = Sun((0.0, np.cos(np.radians(30)), 0.5), (2.0, 1.0, 0.5), np.radians(0.5))
    assert _seen_below(sun=sun) == pytest.approx(0.5 / np.pi * 0.5 * np.array([2.0, 1.0, 0.5]), rel=0.02)


@pytest.mark.parametrize(("look", "draw"), [("classroom", 1), ("classroom", 2), ("lab", 1)])
def test_a_drawn_look_is_neither_black_nor_burnt(arena, robot, tmp_path, look, draw):
    config, _ = draw_look(load_section("look", look), 7, "exposure", draw)
    poses = [(0.55, -0.60, 90), (-0.60, 0.78, 182), (0.30, -1.04, 15)]
    frames = [FramePose(i + 1, 0.2 * i, x, y, float(np.radians(yaw))) for i, (x, y, yaw) in enumerate(poses)]
    job = build_job(arena, robot, config, Render(width_px=96, height_px=72, samples=2), frames, seed=draw)
    (tmp_path / "job.json").write_text(job.to_json())
    render_job(tmp_path / "job.json", tmp_path / "images", threads=2)
    for number in (1, 2, 3):
        grey = cv2.cvtColor(cv2.imread(str(tmp_path / "images" / f"{number:06d}.jpg")), cv2.COLOR_BGR2GRAY)
        assert 70 < np.median(grey) < 180
        assert np.mean(grey >= 250) < 0.1
        assert np.mean(grey <= 5) < 0.1

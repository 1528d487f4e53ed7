"""Pictures put together from parts against those that are traced whole, in linear light, in one Blender process."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from blender_scenes.camera import floor_points, pose_X_WR
from blender_scenes.camera_response import CameraResponse
from blender_scenes.description import INSTANT, FrameView, Intrinsics, Mesh, Moment, Panel, Scene, Shutter, Sky
from blender_scenes.geometry import block, floor, rectangle
from blender_scenes.job import RenderJob
from blender_scenes.sampling import PartSamples, Sampling
from blender_scenes.shading import Color, Coordinate, Mix, Noise, Step, Surface
from configs.schema.look import CameraLook

_PROGRAM = """
import os, sys, json, tempfile
from pathlib import Path
import numpy as np
out = os.fdopen(os.dup(1), "wb")
os.dup2(2, 1)
from blender_scenes.bpy_side import build, engine
from blender_scenes.job import RenderJob
for job, threads, numbers in json.load(sys.stdin):
    job = RenderJob.from_json(job)
    views = {view.number: view for view in job.frames}
    build.start()
    build.build(job.scene, job.camera)
    with tempfile.TemporaryDirectory() as scratch:
        engine.configure(job, threads, Path(scratch))
        pictures = engine.Pictures(job, threads, Path(scratch))
        for number in numbers:
            out.write(pictures.light(views[number]).astype(np.float32).tobytes())
"""
WIDTH_PX, HEIGHT_PX = 64, 48
CAMERA = Intrinsics(WIDTH_PX, HEIGHT_PX, 45.0, 45.0, 31.5, 23.5)
PARTS = PartSamples(light=4, surfaces=16)
WHOLE_SAMPLES = 256
PITCH = np.radians(35.0)
X_RC = np.array(
    [
        [0.0, -np.sin(PITCH), np.cos(PITCH), 0.05],
        [-1.0, 0.0, 0.0, 0.0],
        [0.0, -np.cos(PITCH), -np.sin(PITCH), 0.25],
        [0.0, 0.0, 0.0, 1.0],
    ]
)
ROLLING = Shutter(exposure_s=0.01, read_out_s=0.03)
GLOBAL = Shutter(exposure_s=0.02)
RATE_RAD_S = 6.0
AWAY = (3.0, 3.0, 0.0)


def _asked(*orders: tuple[RenderJob, int, list[int]]) -> list[np.ndarray]:
    """(N, H, W, 3) light of each order: a job, threads, and the numbers of its views."""
    text = json.dumps([(job.to_json(), threads, numbers) for job, threads, numbers in orders])
    call = [sys.executable, "-c", _PROGRAM]
    done = subprocess.run(call, input=text.encode(), capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()[-2000:]
    rest, found = np.frombuffer(done.stdout, np.float32), []
    for job, _, numbers in orders:
        shape = len(numbers), job.camera.height_px, job.camera.width_px, 3
        found.append(rest[: np.prod(shape)].reshape(shape))
        rest = rest[np.prod(shape) :]
    assert not rest.size
    return found


def _matt(name: str, *rgb: float) -> Surface:
    return Surface(name, Color(rgb), roughness=1.0, refractive_index=1.0)


MOTTLED = Mix(Noise((30.0, 30.0), (0.3, 0.7)), Color((0.5, 0.45, 0.4)), Color((0.3, 0.3, 0.3)))
FLOOR = Surface("floor", MOTTLED, roughness=0.6)
STRIPES = Surface("back", Mix(Step(Coordinate("v"), 0.3, 0.31), Color((0.2, 0.5, 0.2)), Color((0.5, 0.2, 0.2))), roughness=1.0)
MIRROR = Surface("mirror", Color((0.9, 0.9, 0.9)), roughness=0.02, metallic=1.0)
GLASS = Surface("glass", Color((1.0, 1.0, 1.0)), roughness=0.0, refractive_index=1.5, transmission=1.0)
BLACK, RED, GREEN = _matt("black", 0.03, 0.03, 0.03), _matt("red", 0.5, 0.08, 0.05), _matt("green", 0.05, 0.4, 0.08)
LAMP = Panel("lamp", (0.9, 0.8, 2.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), 0.4, 0.4, (6.0, 6.0, 5.0))


def _tape(name: str, corners: list[tuple[float, float]]) -> Mesh:
    return rectangle(name, [(x, y, 0.00013) for x, y in corners], "black")


LINE = _tape("tape_0", [(0.0, -0.02), (2.0, -0.02), (2.0, 0.02), (0.0, 0.02)])
ACROSS = _tape("tape_1", [(0.33, -0.5), (0.37, -0.5), (0.37, -0.06), (0.33, -0.06)])
ROBOT = block("chassis", (0.0, 0.0, 0.06), (0.16, 0.14, 0.1), "red")
OBSTACLE = block("obstacle_M", (0.0, 0.0, 0.06), (0.06, 0.06, 0.12), "green")


def _scene(*walls: Mesh) -> Scene:
    meshes = (floor("floor", (-2.0, -2.0), (2.0, 2.0), 0.0, "floor"), LINE, ACROSS, *walls)
    return Scene(
        surfaces=(FLOOR, STRIPES, MIRROR, GLASS, BLACK, RED, GREEN),
        meshes=meshes,
        robot=(ROBOT,),
        panels=(LAMP, replace(LAMP, name="far lamp", center=(-1.0, -1.2, 2.2))),
        sun=None,
        sky=Sky("studio", 0.0, 0.2, 10.0, 1.0),
        moving=(OBSTACLE,),
    )


def _at(number: int, pose: tuple[float, float, float], moving: tuple[float, float, float] = AWAY) -> FrameView:
    return FrameView(number, 0.0, pose, _rows(pose), (moving,))


def _rows(pose: tuple[float, float, float]) -> tuple:
    return tuple(tuple(row) for row in (pose_X_WR(*pose) @ X_RC).tolist())


def _turning(number: int, length_s: float) -> FrameView:
    """On the spot, for the whole of a window around straight ahead."""
    yaws = RATE_RAD_S * length_s * np.linspace(-0.5, 0.5, 5)
    moments = tuple(Moment((0.0, 0.0, yaw), _rows((0.0, 0.0, yaw)), (AWAY,)) for yaw in yaws.tolist())
    return replace(_at(number, (0.0, 0.0, 0.0)), exposure=moments)


def _job(scene: Scene, views: list[FrameView], parts: PartSamples | None, shutter: Shutter = INSTANT) -> RenderJob:
    sampling = Sampling(seed=1, samples=WHOLE_SAMPLES, denoise=False, parts=parts)
    response = CameraResponse.from_look(CameraLook(), (1.0, 1.0, 1.0), 1, 92)
    return RenderJob(RenderJob.FORMAT, scene, CAMERA, tuple(views), sampling, response, shutter)


BOX = block("wall_A", (0.75, -0.22, 0.1), (0.1, 0.2, 0.2), "back")
STILL = [_at(1, (0.0, 0.0, 0.0)), _at(2, (0.0, 0.0, 0.0), (0.5, 0.15, 0.4)), _at(3, (0.0, 0.0, 0.0), (0.45, -0.12, 0.0))]
"""The obstacle away, on the left, and on the right."""


@pytest.fixture(scope="module")
def pictures() -> dict[str, np.ndarray]:
    """Of each name (N, H, W, 3): 'parts' and 'whole' of three views, of fast turns, and of walls one sees through."""
    seen = _scene(BOX)
    behind = _scene(block("wall_G", (0.5, 0.0, 0.15), (0.01, 0.6, 0.3), "glass"))
    before = _scene(block("wall_M", (0.6, 0.0, 0.15), (0.02, 0.6, 0.3), "mirror"))
    rolling, at_once = [_turning(1, ROLLING.exposure_s + ROLLING.read_out_s)], [_turning(1, GLOBAL.exposure_s)]
    orders = {
        "still": (seen, STILL, INSTANT),
        "at once": (seen, at_once, GLOBAL),
        "rolling": (seen, rolling, ROLLING),
        "glass": (behind, STILL[:1], INSTANT),
        "mirror": (before, STILL[:1], INSTANT),
    }
    names, asked = [], []
    for name, (scene, views, shutter) in orders.items():
        for kind, parts in (("parts", PARTS), ("whole", None)):
            names.append(f"{name} {kind}")
            asked.append((_job(scene, views, parts, shutter), 2, [view.number for view in views]))
    return dict(zip(names, _asked(*asked), strict=True))

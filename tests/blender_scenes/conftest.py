"""The shipped arena and robot, read without the loader, and the linear light of any scene out of Cycles."""

import json
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
import yaml

import configs
from blender_scenes.render.job import RenderJob
from blender_scenes.render.sampling import TracingSettings
from blender_scenes.scene.description import Scene
from configs.schema.arena import ArenaConfig
from configs.schema.look import CameraLook
from configs.schema.robot import RobotConfig
from sensors.camera.response import CameraResponse
from sensors.camera.views import INSTANT, FrameView
from symolo.arena.geometry import Arena
from symolo.core.geometry.lens import NO_DISTORTION, Coefficients
from symolo.core.geometry.pinhole import Intrinsics, Shutter

_SHIPPED = Path(configs.__file__).parent


@pytest.fixture(scope="session")
def arena() -> Arena:
    text = (_SHIPPED / "arenas" / "symolo.yaml").read_text()
    return Arena.from_config(ArenaConfig.model_validate(yaml.safe_load(text)))


@pytest.fixture(scope="session")
def robot() -> RobotConfig:
    text = (_SHIPPED / "robots" / "nominal.yaml").read_text()
    return RobotConfig.model_validate(yaml.safe_load(text))


_PROGRAM = """
import os, sys, json, tempfile
from pathlib import Path
from unittest import mock
import numpy as np
out = os.fdopen(os.dup(1), "wb")
os.dup2(2, 1)
from blender_scenes.blender_side import build, engine
from blender_scenes.blender_side.hybrid import images as hybrid_images
from blender_scenes.render.job import RenderJob
orders, near_width_px, user_files = json.load(sys.stdin)
if near_width_px:
    mock.patch.object(hybrid_images, "_NEAR_WIDTH_PX", near_width_px).start()
for job, threads, numbers in orders:
    job = RenderJob.from_json(job)
    by_number = {view.number: view for view in job.frames}
    views = job.frames if numbers is None else [by_number[number] for number in numbers]
    build.start()
    build.build(job.scene, job.camera, Path(user_files) if user_files else None)
    with tempfile.TemporaryDirectory() as scratch:
        engine.configure(job, threads, Path(scratch))
        images = engine.FrameTracer(job, threads, Path(scratch))
        for view in views:
            out.write(images.light(view).astype(np.float32).tobytes())
"""
Order = tuple[RenderJob, int, list[int] | None]
"""A job, threads, and the numbers of its views; None for all of them as they come."""


def _lights(
    orders: Sequence[Order], near_width_px: int | None = None, user_files: Path | None = None
) -> list[np.ndarray]:
    """(N, H, W, 3) linear light of each order, all made in one Blender process."""
    jobs = [(job.to_json(), threads, numbers) for job, threads, numbers in orders]
    sent = json.dumps((jobs, near_width_px, str(user_files) if user_files else None)).encode()
    done = subprocess.run([sys.executable, "-c", _PROGRAM], input=sent, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()[-2000:]
    rest, found = np.frombuffer(done.stdout, np.float32), []
    for job, _, numbers in orders:
        shape = len(job.frames if numbers is None else numbers), job.camera.height_px, job.camera.width_px, 3
        found.append(rest[: np.prod(shape)].reshape(shape))
        rest = rest[np.prod(shape) :]
    assert not rest.size
    return found


@pytest.fixture(scope="session")
def light_of() -> Callable[..., np.ndarray]:
    """Linear light (N, P, P, 3) of N views of a scene, P pixels wide and high, before any camera response."""

    def traced(
        scene: Scene,
        views: Sequence[FrameView],
        pixels: int,
        focal_px: float,
        shutter: Shutter = INSTANT,
        lens: Coefficients = NO_DISTORTION,
        user_files: Path | None = None,
    ) -> np.ndarray:
        middle = 0.5 * (pixels - 1)
        job = RenderJob(
            format=RenderJob.FORMAT,
            scene=scene,
            camera=Intrinsics(pixels, pixels, focal_px, focal_px, middle, middle, lens),
            frames=tuple(views),
            sampling=TracingSettings(seed=1, samples=64, denoise=False),
            response=CameraResponse.from_look(CameraLook(), (1.0, 1.0, 1.0), 1, 92),
            shutter=shutter,
        )
        (light,) = _lights([(job, 1, None)], user_files=user_files)
        return light

    return traced


@pytest.fixture(scope="session")
def lights_of() -> Callable[..., list[np.ndarray]]:
    """(N, H, W, 3) linear light of each order, all made in one Blender process."""

    def traced(*orders: Order, near_width_px: int | None = None) -> list[np.ndarray]:
        """`near_width_px`: what the light of an image from parts has at least, for small ones to share its pixels."""
        return _lights(orders, near_width_px)

    return traced

"""The shipped arena and robot, read without the loader, and the linear light of any scene out of Cycles."""

import json
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
import yaml

import configs
from blender_scenes.render.job import RenderJob
from blender_scenes.render.light_paths import LIGHT_PATHS, LightPathLimits
from blender_scenes.render.sampling import TracingSettings
from blender_scenes.scene.description import Scene
from configs.schema.appearance.look import CameraLook
from configs.schema.arena import ArenaConfig
from configs.schema.robot import RobotConfig
from sensors.camera.response import CameraResponse
from sensors.camera.views import INSTANT, FrameView
from symolo.arena.geometry import Arena
from symolo.core.geometry.lens import NO_DISTORTION, Coefficients
from symolo.core.geometry.pinhole import Intrinsics, Shutter

_RENDER = """
import json, sys, tempfile
from pathlib import Path
from types import SimpleNamespace
from blender_scenes.blender_side.__main__ import _render
from blender_scenes.blender_side.loading import load_bpy
from blender_scenes.render.protocol import RenderRequest
load_bpy(1)
nobody = SimpleNamespace(send=lambda message: None)
for request in json.load(sys.stdin):
    with tempfile.TemporaryDirectory() as scratch:
        _render(RenderRequest.model_validate(request), nobody, Path(scratch))
"""
"""What a Blender process does for one job, for several in one process: most of a small image's time is its start."""
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
from dataclasses import replace
from pathlib import Path
from unittest import mock
import numpy as np
out = os.fdopen(os.dup(1), "wb")
os.dup2(2, 1)
import bpy
from blender_scenes.blender_side import build, engine
from blender_scenes.blender_side.hybrid import floor_maps, images
from blender_scenes.render.job import RenderJob
orders, near_width_px, times_coarser, user_files = json.load(sys.stdin)
if near_width_px:
    mock.patch.object(images, "_NEAR_WIDTH_PX", near_width_px).start()
build.start()
tilings = {name: getattr(floor_maps, name) for name in ("_IRRADIANCE", "_RELIEF")}
for (job, threads, numbers), coarser in zip(orders, times_coarser, strict=True):
    for name, tiling in tilings.items():
        texel_m, core, margin = coarser * tiling.texel_m, tiling.core // coarser, tiling.margin // coarser
        setattr(floor_maps, name, replace(tiling, texel_m=texel_m, core=core, margin=margin))
    job = RenderJob.from_json(job)
    by_number = {view.number: view for view in job.frames}
    views = job.frames if numbers is None else [by_number[number] for number in numbers]
    # An empty file again; the settings are still those of the factory, and to load these takes five times as long.
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    files = Path(user_files) if user_files else None
    build.build(job.scene, job.camera, files, caustics=job.sampling.paths.caustics)
    with tempfile.TemporaryDirectory() as scratch:
        engine.configure(job, threads, Path(scratch))
        tracer = engine.FrameTracer(job, threads, Path(scratch), metered=1.0)
        for view in views:
            out.write(tracer.light(view).astype(np.float32).tobytes())
"""
Order = tuple[RenderJob, int, list[int] | None]
"""A job, threads, and the numbers of its views; None for all of them as they come."""


def _lights(
    orders: Sequence[Order],
    near_width_px: int | None = None,
    coarser: int | Sequence[int] = 1,
    user_files: Path | None = None,
) -> list[np.ndarray]:
    """Return the linear light (N, H, W, 3) of each order, all rendered in one Blender process."""
    jobs = [(job.to_json(), threads, numbers) for job, threads, numbers in orders]
    times_coarser = [coarser] * len(orders) if isinstance(coarser, int) else coarser
    sent = json.dumps((jobs, near_width_px, times_coarser, str(user_files) if user_files else None)).encode()
    done = subprocess.run([sys.executable, "-c", _PROGRAM], input=sent, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()[-2000:]
    rest, lights = np.frombuffer(done.stdout, np.float32), []
    for job, _, numbers in orders:
        shape = len(job.frames if numbers is None else numbers), job.camera.height_px, job.camera.width_px, 3
        lights.append(rest[: np.prod(shape)].reshape(shape))
        rest = rest[np.prod(shape) :]
    assert not rest.size
    return lights


def _light_job(
    scene: Scene,
    views: Sequence[FrameView],
    pixels: int,
    focal_px: float,
    shutter: Shutter = INSTANT,
    lens: Coefficients = NO_DISTORTION,
    samples: int = 64,
    paths: LightPathLimits = LIGHT_PATHS["standard"],
    *,
    denoise: bool = False,
) -> RenderJob:
    """Return the job of images of a scene, P pixels wide and high, traced in full."""
    middle = 0.5 * (pixels - 1)
    return RenderJob(
        format=RenderJob.FORMAT,
        scene=scene,
        camera=Intrinsics(pixels, pixels, focal_px, focal_px, middle, middle, lens),
        frames=tuple(views),
        sampling=TracingSettings(seed=1, samples=samples, denoise=denoise, paths=paths),
        response=CameraResponse.from_look(CameraLook(), (1.0, 1.0, 1.0), 1, 92),
        shutter=shutter,
    )


@pytest.fixture(scope="session")
def light_of() -> Callable[..., np.ndarray]:
    """Linear light (N, P, P, 3) of N views of a scene, P pixels wide and high, before any camera response."""

    def traced(*arguments: object, user_files: Path | None = None, **options: object) -> np.ndarray:
        """Render a job; the arguments are those of `_light_job`."""
        (light,) = _lights([(_light_job(*arguments, **options), 1, None)], user_files=user_files)
        return light

    return traced


@pytest.fixture(scope="session")
def lights_of_scenes() -> Callable[..., list[dict[str, np.ndarray]]]:
    """Linear light (N, P, P, 3) of N views of each of several scenes by name, under each of several limits of light
    paths, all rendered in one Blender process."""

    def traced(
        scenes: dict[str, tuple[Scene, Sequence[FrameView]]],
        pixels: int,
        focal_px: float,
        paths: Sequence[LightPathLimits] = (LIGHT_PATHS["standard"],),
    ) -> list[dict[str, np.ndarray]]:
        """Render all views of all scenes."""
        jobs = (_light_job(*seen, pixels, focal_px, paths=limits) for limits in paths for seen in scenes.values())
        lights = iter(_lights([(job, 1, None) for job in jobs]))
        return [{name: next(lights) for name in scenes} for _ in paths]

    return traced


@pytest.fixture(scope="session")
def lights_of() -> Callable[..., list[np.ndarray]]:
    """Linear light (N, H, W, 3) of each order, all rendered in one Blender process."""

    def traced(*orders: Order, near_width_px: int | None = None, coarser: int | Sequence[int] = 1) -> list[np.ndarray]:
        """Render some orders.

        Args:
            orders: What is rendered.
            near_width_px: Minimum width of the light image of hybrid rendering, so that pixels of small images share
                its pixels.
            coarser: Number of times that the texels of hybrid rendering's light maps are larger, for all orders or for
                each; most of the time goes into them.
        """
        return _lights(orders, near_width_px, coarser)

    return traced


@pytest.fixture(scope="session")
def images_of() -> Callable[[Mapping[Path, RenderJob]], None]:
    """Renders the images of jobs in one Blender process, below `images` in the folder of each job."""

    def rendered(jobs: Mapping[Path, RenderJob]) -> None:
        requests = []
        for folder, job in jobs.items():
            (folder / "images").mkdir()
            (folder / "job.json").write_text(job.to_json())
            requests.append(
                {
                    "work": "images",
                    "job_path": str(folder / "job.json"),
                    "folder": str(folder / "images"),
                    "numbers": [view.number for view in job.frames],
                    "threads": 1,
                }
            )
        done = subprocess.run(
            [sys.executable, "-c", _RENDER], input=json.dumps(requests).encode(), capture_output=True, check=False
        )
        assert done.returncode == 0, done.stderr.decode()[-2000:]

    return rendered

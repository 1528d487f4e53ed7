"""Where the samples of references lie: at an edge, they show how much of a pixel is on either side of it."""

import json
import subprocess
import sys

import numpy as np
import pytest

from blender_scenes.render.job import RenderJob
from blender_scenes.render.sampling import TracingSettings
from blender_scenes.scene.description import LightPanel, Scene, Sky
from configs.schema.appearance.look import CameraLook
from sensors.camera.response import CameraResponse
from sensors.camera.views import FrameView
from symolo.core.geometry.pinhole import Intrinsics

_PROGRAM = """
import os, sys, json, tempfile
from pathlib import Path
import numpy as np
out = os.fdopen(os.dup(1), "wb")
os.dup2(2, 1)
from blender_scenes.blender_side import build, engine
from blender_scenes.render.job import RenderJob
text, samples, seeds = json.load(sys.stdin)
job = RenderJob.from_json(text)
view, size = job.frames[0], (job.camera.width_px, job.camera.height_px)
build.start()
build.build(job.scene, job.camera)
with tempfile.TemporaryDirectory() as scratch:
    engine.configure(job, 1, Path(scratch))
    image = lambda: engine.traced_light(view, size, seed=1, samples=2)
    lights = [image()]
    lights += [engine.reference_light(view, size, seed=seed, samples=count) for count in samples for seed in seeds]
    for light in [*lights, image()]:
        out.write(light.tobytes())
"""
UP = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
PIXELS, FOCAL_PX, FAR_M, WIDE_M = 24, 100.0, 2.0, 10.0
COLUMN = 15
"""The edge is in the middle of the pixels of this column."""
EDGE_M = (COLUMN - 0.5 * (PIXELS - 1)) / FOCAL_PX * FAR_M
LAMP = LightPanel(
    "lamp", (EDGE_M - 0.5 * WIDE_M, 0.0, FAR_M), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), WIDE_M, WIDE_M, (1.0, 1.0, 1.0)
)
"""A lamp of radiance 1 above the camera, left of the edge; right of it there is nothing."""
SAMPLES, SEEDS = (1, 2, 4, 8, 64), (1, 2, 3, 4, 5, 6, 7, 8)


@pytest.fixture(scope="module")
def lights() -> np.ndarray:
    """Light (N, P, P) of an image, of references by number of samples and seed, and of the image once more."""
    middle = 0.5 * (PIXELS - 1)
    job = RenderJob(
        format=RenderJob.FORMAT,
        scene=Scene((), (), robot=(), panels=(LAMP,), sun=None, sky=Sky("studio", 0.0, 0.0, 10.0, 1.0)),
        camera=Intrinsics(PIXELS, PIXELS, FOCAL_PX, FOCAL_PX, middle, middle),
        frames=(FrameView(1, 0.0, (0.0, 0.0, 0.0), UP),),
        sampling=TracingSettings(seed=1, samples=1, denoise=False),
        response=CameraResponse.from_look(CameraLook(), (1.0, 1.0, 1.0), 1, 92),
    )
    sent = json.dumps((job.to_json(), SAMPLES, SEEDS)).encode()
    done = subprocess.run([sys.executable, "-c", _PROGRAM], input=sent, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()[-2000:]
    return np.frombuffer(done.stdout, np.float32).reshape(-1, PIXELS, PIXELS, 3)[..., 0]


@pytest.fixture(scope="module")
def edge(lights) -> dict[int, np.ndarray]:
    """Light (seeds, rows) of the pixels with the edge, by the number of samples."""
    return dict(zip(SAMPLES, lights[1:-1, :, COLUMN].reshape(len(SAMPLES), len(SEEDS), PIXELS), strict=True))


def test_one_sample_sees_either_side_of_an_edge_by_chance(edge):
    """A mean of 192 draws of 0 or 1 has a standard deviation of 0.036; each seed has others."""
    assert edge[1].mean() == pytest.approx(0.5, abs=4 * 0.036)
    assert np.ptp(edge[1].mean(axis=1)) > 0


@pytest.mark.parametrize("samples", SAMPLES[1:])
def test_samples_lie_evenly_on_both_sides_of_an_edge_through_the_middle_of_a_pixel(edge, samples):
    """Each half of the filter has as many samples as the other, because a block of a Sobol sequence is stratified.

    Cycles rounds positions, so a sample beside the edge may be on the other side of it. A sample in the middle of the
    pixel, the same for each seed, would leave too many on one side in half of the pixels.
    """
    assert np.abs(edge[samples] - 0.5).max() <= 1 / samples + 1e-6
    assert np.mean(np.abs(edge[samples] - 0.5) < 1e-6) > 0.95


def test_references_do_not_change_the_samples_of_later_images(lights):
    assert np.array_equal(lights[0], lights[-1])
    assert lights[0].max() == pytest.approx(1.0)

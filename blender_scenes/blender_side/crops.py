"""Errors of a rendering on crops of a few views of a run, from references with other random numbers."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import numpy as np

from blender_scenes.blender_side.engine import FrameTracer, noise_seed, traced_light
from blender_scenes.blender_side.rendering import Part
from blender_scenes.render.crop_errors import mean_square_errors
from blender_scenes.render.job import RenderJob
from blender_scenes.render.probe import CropErrors, TracedSamples, probed_numbers
from blender_scenes.render.sampling import HybridSamples
from sensors.camera.lens_warp import pinhole_image
from sensors.camera.views import FrameView
from symolo.core.arrays import FloatImage
from symolo.core.random_streams import stream

_CORE_PX = 48, 40
"""Maximum width and height of the part of a crop that counts; each view has one in its upper and one in its lower half.

The noise of the estimate falls with the square of the reference's samples and the square root of its pixels, so few
pixels with many samples cost least."""
_AROUND_PX = 24
"""Pixels around it that the denoiser sees as well."""
_HYBRID_AROUND_PX = 8
_REFERENCE_SAMPLES = 48


@dataclass(frozen=True)
class Crop:
    view: FrameView
    core: Part
    references: tuple[FloatImage, FloatImage]
    """Linear light (h, w, 3) of the core."""


class CropProbe:
    """The crops of a job whose scene is in Blender, after `engine.configure`."""

    def __init__(
        self, job: RenderJob, threads: int, scratch: Path, metered: float, on_step: Callable[[], None]
    ) -> None:
        """Trace the references.

        Args:
            job: Job.
            threads: Number of threads.
            scratch: Folder for temporary files.
            metered: Median luminance of the run.
            on_step: Called after each rendering.
        """
        self._job, self._threads, self._scratch, self._metered = job, threads, scratch, metered
        self._on_step = on_step
        self.hybrid: FrameTracer | None = None
        """The tracer of hybrid rendering, with the maps that it has made, once its errors are measured."""
        camera = pinhole_image(job.camera).camera
        self._size = camera.width_px, camera.height_px
        FrameTracer(job, threads, scratch, metered)  # sets the limit on the light of a path
        numbers = probed_numbers(len(job.frames))
        self._crops = [self._crop(job.frames[number], half) for number in numbers for half in range(2)]

    def errors(self, candidate: HybridSamples | TracedSamples) -> CropErrors:
        """Return the errors of a candidate in each view."""
        lights = self._hybrid(candidate) if isinstance(candidate, HybridSamples) else self._full(candidate)
        by_view: dict[int, list[tuple[float, float]]] = {}
        for crop, light in zip(self._crops, lights, strict=True):
            errors = mean_square_errors(light, crop.references, self._job.response, self._metered, crop.view.number)
            by_view.setdefault(crop.view.number, []).append(errors)
        means = np.array([np.mean(errors, axis=0) for errors in by_view.values()])
        return CropErrors(tuple(means[:, 0].tolist()), tuple(means[:, 1].tolist()))

    def _crop(self, view: FrameView, half: int) -> Crop:
        width, height = (min(px, side) for px, side in zip(_CORE_PX, self._size, strict=True))
        random = stream(self._job.sampling.seed, "probe", view.number, half)
        free = self._size[1] - height + 1
        left = int(random.integers(self._size[0] - width + 1))
        top = int(random.integers(half * free // 2, max((half + 1) * free // 2, half * free // 2 + 1)))
        core = Part(left, min(top, free - 1), width, height)
        first, second = (self._traced(view, core, _REFERENCE_SAMPLES, f"reference {k}", denoise=False) for k in (1, 2))
        return Crop(view, core, (first, second))

    def _full(self, candidate: TracedSamples) -> list[FloatImage]:
        cycles = bpy.context.scene.cycles
        cycles.denoising_prefilter, cycles.denoising_quality = candidate.prefilter, candidate.denoise_quality
        lights = []
        for crop in self._crops:
            part = crop.core.grown(_AROUND_PX, self._size)
            light = self._traced(crop.view, part, candidate.samples, "candidate", denoise=True)
            lights.append(crop.core.cut(light, part))
        return lights

    def _traced(self, view: FrameView, part: Part, samples: int, name: str, *, denoise: bool) -> FloatImage:
        seed = noise_seed(self._job.sampling.seed, "probe", name, view.number)
        light = traced_light(view, self._size, seed=seed, samples=samples, denoise=denoise, part=part)
        self._on_step()
        return light * np.array(view.light_gain, np.float32)

    def _hybrid(self, candidate: HybridSamples) -> list[FloatImage]:
        job = replace(self._job, sampling=replace(self._job.sampling, hybrid=candidate))
        self.hybrid = tracer = FrameTracer(job, self._threads, self._scratch, self._metered)
        images: dict[int, FloatImage] = {}
        for crop in self._crops:
            if crop.view.number not in images:
                cores = [other.core for other in self._crops if other.view.number == crop.view.number]
                parts = [core.grown(_HYBRID_AROUND_PX, self._size) for core in cores]
                images[crop.view.number] = tracer.pinhole_light(crop.view, parts)
                self._on_step()
        return [crop.core.cut(images[crop.view.number]) for crop in self._crops]

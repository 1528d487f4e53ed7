"""The plain Cycles loop with Blender's denoiser that reaches the error of another rendering with the fewest samples."""

import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace

from benchmarks.render.contenders.render_process import RenderProcess
from blender_scenes.render.devices import DeviceKind
from blender_scenes.render.job import RenderJob
from symolo.core.arrays import FloatImage

RUN_FRAMES = 200
"""Over which a run spreads its start."""
_DENOISED = {"use_denoising": True, "denoiser": "OPENIMAGEDENOISE", "denoising_input_passes": "RGB_ALBEDO_NORMAL"}
BLENDERS_DEFAULT = {**_DENOISED, "denoising_prefilter": "ACCURATE", "denoising_quality": "HIGH"}
PLAIN_SAMPLES = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)
"""Numbers of samples that are tried."""


@dataclass(frozen=True)
class RunCost:
    """Core-seconds on the processor."""

    set_up_s: float
    """Start, scene, and what precedes the first image of a run."""
    image_s: float

    @property
    def per_image_s(self) -> float:
        """Return the cost of one image of a long run, everything included."""
        return self.image_s + self.set_up_s / RUN_FRAMES


def plain_lights(
    job: RenderJob, numbers: list[int], threads: int, device: DeviceKind
) -> Mapping[int, Mapping[int, FloatImage]]:
    """Return the light of each view by the number of samples, as the plain loop renders it on a device."""
    job = replace(job, sampling=replace(job.sampling, device=device))
    settings = {"kind": "plain", "cycles": BLENDERS_DEFAULT, "each_of": PLAIN_SAMPLES}
    with RenderProcess("cycles_process.py", job, settings, threads, sys.executable) as process:
        process.render(numbers)
        return {number: dict(zip(PLAIN_SAMPLES, process.light(number), strict=True)) for number in numbers}


def plain_cost(job: RenderJob, numbers: list[int], threads: int, samples: int) -> RunCost:
    """Return the cost of the plain loop on the processor, after a first image of one sample."""
    settings = {"kind": "plain", "cycles": {**BLENDERS_DEFAULT, "samples": samples}}
    with RenderProcess("cycles_process.py", job, settings, threads, sys.executable) as process:
        first = process.render(numbers[:1], warm_up=True)
        cost = process.render(numbers)
        return RunCost(process.set_up.core_s + first.core_s, cost.core_s / len(numbers))


def fewest_samples(mean_squares: Mapping[int, float], largest: float) -> int | None:
    """Return the smallest number of samples whose error is not larger; None if none is."""
    return next((samples for samples, error in sorted(mean_squares.items()) if error <= largest), None)

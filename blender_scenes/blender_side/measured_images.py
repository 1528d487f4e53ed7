"""Errors of a rendering in a few images of a run, from references with other random numbers."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from blender_scenes.blender_side.engine import FrameTracer, noise_seed, traced_light
from blender_scenes.render.image_errors import ImageError, image_error
from blender_scenes.render.job import RenderJob
from blender_scenes.render.probe import Candidate, ImageErrors, probed_numbers, with_candidate
from sensors.camera.views import FrameView
from symolo.core.arrays import FloatImage

_REFERENCES, _REFERENCE_SAMPLES = 4, 8
"""Number of references of an image, and samples of each. Their noise cancels in the mean over an image, whose standard
error falls with the number of samples and the square roots of the numbers of pixels and of pairs of references. Whole
images with few samples cost more than small parts with many, but no part of an image goes unseen."""


@dataclass(frozen=True)
class _Measured:
    view: FrameView
    references: tuple[FloatImage, ...]
    """Linear light (H, W, 3) of the pinhole image."""


class Probe:
    """The images of a job on which candidates are measured; its scene is in Blender, after `engine.configure`."""

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
        # It sets the limit on the light of a path.
        self.tracer = FrameTracer(replace(job, sampling=replace(job.sampling, hybrid=None)), threads, scratch, metered)
        """The tracer of the candidate that was measured last, with the maps that it has made."""
        self._measured = [self._with_references(job.frames[number]) for number in probed_numbers(len(job.frames))]

    def errors(self, candidate: Candidate) -> ImageErrors:
        """Return the errors of a candidate in each image, which it renders as it would render it for the run.

        Hybrid rendering is refused at the first image that is too bad, because it needs other maps in other places.
        """
        job = replace(self._job, sampling=with_candidate(self._job.sampling, candidate))
        self.tracer = FrameTracer(job, self._threads, self._scratch, self._metered)
        errors = (self._errors_in(measured) for measured in self._measured)
        return ImageErrors.until_refused(errors) if job.sampling.hybrid else ImageErrors.of(errors)

    def _errors_in(self, measured: _Measured) -> ImageError:
        view, response = measured.view, self._job.response
        light = self.tracer.pinhole_light(view)
        self._on_step()
        return image_error(light, measured.references, response, self._metered, view.number)

    def _with_references(self, view: FrameView) -> _Measured:
        return _Measured(view, tuple(self._reference(view, number + 1) for number in range(_REFERENCES)))

    def _reference(self, view: FrameView, number: int) -> FloatImage:
        seed = noise_seed(self._job.sampling.seed, "probe", f"reference {number}", view.number)
        size = self.tracer.size
        light = traced_light(view, size, seed=seed, samples=_REFERENCE_SAMPLES, denoise=False)
        self._on_step()
        return light * np.array(view.light_gain, np.float32)

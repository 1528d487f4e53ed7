"""Errors of a rendering in a few images of a run, from references with other random numbers."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from blender_scenes.blender_side.engine import FrameTracer, noise_seed, reference_light
from blender_scenes.render.image_errors import ImageError, image_error
from blender_scenes.render.job import RenderJob
from blender_scenes.render.probe import (
    FIRST_SAMPLES,
    REFERENCES,
    Candidate,
    ImageErrors,
    probed_numbers,
    with_candidate,
)
from blender_scenes.render.sampling import HybridSamples
from sensors.camera.views import FrameView
from symolo.core.arrays import FloatImage


class _Measured:
    """An image that is measured."""

    def __init__(self, view: FrameView) -> None:
        self.view = view
        self.references: list[FloatImage] = []
        """Linear light (H, W, 3) of the pinhole image."""
        self.light: FloatImage | None = None
        """Linear light (H, W, 3) of the candidate that is measured; None if it has not rendered this image."""


class Probe:
    """The images of a job on which candidates are measured; its scene is in Blender, after `engine.configure`.

    The noise of the references cancels in the mean over an image, whose standard error is inversely proportional to
    their samples and to the square roots of the numbers of pixels and of pairs of references. Whole images with few
    samples cost more than small parts with many, but no part of an image goes unseen.
    """

    def __init__(
        self, job: RenderJob, threads: int, scratch: Path, metered: float, on_step: Callable[[], None]
    ) -> None:
        """Trace nothing yet.

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
        self._candidate: Candidate | None = None
        self._measured = [_Measured(job.frames[number]) for number in probed_numbers(len(job.frames))]
        self._samples = 0

    def measure(self, candidate: Candidate, samples: int) -> ImageErrors:
        """Return the errors of a candidate, whose images are rendered as they would be for the run.

        The references have so many samples each, or more if an earlier call asked for more.
        Hybrid rendering is refused at the first image that is too bad, because it needs other maps in other places.
        """
        self.refine(samples)
        if candidate != self._candidate:
            job = replace(self._job, sampling=with_candidate(self._job.sampling, candidate))
            self.tracer = FrameTracer(job, self._threads, self._scratch, self._metered)
            self._candidate = candidate
            for measured in self._measured:
                measured.light = None
        errors = (self._errors_in(measured) for measured in self._measured)
        return (
            ImageErrors.until_refused(errors)
            if isinstance(candidate, HybridSamples)
            else ImageErrors.from_images(errors)
        )

    def refine(self, samples: int) -> None:
        """Trace the references until each has so many samples, in steps that depend on the number of samples only."""
        while self._samples < samples:
            traced = self._samples or FIRST_SAMPLES
            for measured in self._measured:
                new = [self._reference(measured.view, number + 1, traced) for number in range(REFERENCES)]
                pairs = zip(measured.references or new, new, strict=True)
                measured.references = [0.5 * (old + other) for old, other in pairs]
            self._samples += traced

    def _errors_in(self, measured: _Measured) -> ImageError:
        view, response = measured.view, self._job.response
        if measured.light is None:
            measured.light = self.tracer.pinhole_light(view)
            self._on_step()
        return image_error(measured.light, measured.references, response, self._metered, view.number)

    def _reference(self, view: FrameView, number: int, samples: int) -> FloatImage:
        words = ("reference", number) if self._samples == 0 else ("reference", number, self._samples)
        seed = noise_seed(self._job.sampling.seed, "probe", " ".join(map(str, words)), view.number)
        light = reference_light(view, self.tracer.size, seed=seed, samples=samples)
        self._on_step()
        return light * np.array(view.light_gain, np.float32)

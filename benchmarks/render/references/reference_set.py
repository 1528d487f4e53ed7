"""Errors of views from references of complete light paths with independent random numbers, without a denoiser."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from benchmarks.render.contenders.render_process import RenderProcess
from benchmarks.render.references.views import Views
from blender_scenes.render.devices import DeviceKind
from blender_scenes.render.image_errors import ImageError, image_error
from blender_scenes.render.light_paths import LIGHT_PATHS
from sensors.camera.metering import median_luminance
from symolo.core.arrays import FloatImage

_FIRST_SAMPLES, _CERTAIN = 128, 0.1
"""Samples of each reference at first, and the standard error of an image, relative to the error of JPEG, above which
the references get twice the samples."""
_SEEDS = (101, 202)
"""Of the two references; later samples have other seeds."""

Pairs = Mapping[int, tuple[FloatImage, FloatImage]]
"""Two images of the light by the number of the view."""


@dataclass(frozen=True)
class Judged:
    """Views that are judged, and how their references are rendered."""

    views: Views
    numbers: list[int]
    threads: int
    device: DeviceKind

    def references(self, samples: int, seeds: tuple[int, int]) -> Pairs:
        """Return two images of the light of each view, with other random numbers."""
        job = self.views.job
        job = replace(job, sampling=replace(job.sampling, paths=LIGHT_PATHS["complete"], device=self.device))
        settings = {"kind": "references", "samples": samples, "seeds": seeds}
        with RenderProcess("cycles_process.py", job, settings, self.threads, sys.executable) as process:
            process.render(self.numbers)
            pairs = {number: process.light(number) for number in self.numbers}
        return {number: (first, second) for number, (first, second) in pairs.items()}


@dataclass(frozen=True)
class ReferenceSet:
    """The judged views of a case."""

    judged: Judged
    references: Pairs
    metered: float

    @classmethod
    def from_pairs(cls, judged: Judged, references: Pairs) -> Self:
        light = np.concatenate([light.reshape(-1, 3) for pair in references.values() for light in pair])
        return cls(judged, references, median_luminance(light))

    def error(self, number: int, light: FloatImage) -> ImageError:
        """Return the mean square error of a view, at least 0.01, and that of its JPEG."""
        response = self.judged.views.noisy().response
        error = image_error(light, self.references[number], response, self.metered, number)
        return replace(error, rendering=max(error.rendering, 0.01))

    def mean_error(self, by_view: Mapping[int, FloatImage]) -> float:
        return float(np.mean([self.error(number, by_view[number]).rendering for number in self.judged.numbers]))

    def uncertainty(self, by_view: Mapping[int, FloatImage]) -> float:
        """Return the largest standard error of the error of a view, relative to the error of JPEG."""
        errors = [self.error(number, by_view[number]) for number in self.judged.numbers]
        return max(error.standard_error / error.jpeg for error in errors)


def sufficient_references(judged: Judged, lights: Sequence[Mapping[int, FloatImage]], most: int) -> ReferenceSet:
    """Return references of as many samples as the errors of `lights` need, or of the largest number."""
    samples = min(_FIRST_SAMPLES, most)
    reference_set = ReferenceSet.from_pairs(judged, judged.references(samples, _SEEDS))
    while samples < most and any(reference_set.uncertainty(light) > _CERTAIN for light in lights):
        traced = min(samples, most - samples)
        new, share = judged.references(traced, (_SEEDS[0] + samples, _SEEDS[1] + samples)), traced / (samples + traced)
        pairs = {number: _mixed(pair, new[number], share) for number, pair in reference_set.references.items()}
        samples += traced
        reference_set = ReferenceSet.from_pairs(judged, pairs)
    return reference_set


def _mixed(
    pair: tuple[FloatImage, FloatImage], new: tuple[FloatImage, FloatImage], share: float
) -> tuple[FloatImage, FloatImage]:
    first, second = (old + np.float32(share) * (other - old) for old, other in zip(pair, new, strict=True))
    return first, second

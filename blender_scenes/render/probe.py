"""Choice of the cheapest rendering of a run whose error is no larger than that of JPEG, from measurements on crops.

Some looks need many more samples than others, and hybrid rendering is accurate enough under some looks only. So the
Blender process measures a few crops of a run (`blender_side/crops.py`), and this module decides. The measurement
depends on the job alone, so all processes that share a run decide alike.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from pydantic import TypeAdapter

from blender_scenes.render.sampling import HybridSamples, TracingSettings
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.documents.rendering_record import ImageErrorRecord

PROBE = "probe.json"
"""File beside the folder of the images, with the decision."""
PROBE_VIEWS = 4
_MARGIN = 10 ** (-0.5 / 10)
"""Maximum ratio of the mean square errors of a rendering and of JPEG, over all crops."""
_WORST = 10 ** (1 / 10)
"""Maximum of the same ratio in one view."""
_MIN_MEAN_SQUARE = 0.01
"""Lower limit of a stated error, which the noise of the estimate may make negative."""


@dataclass(frozen=True)
class TracedSamples:
    """A candidate of full rendering."""

    samples: int
    prefilter: str = "ACCURATE"
    denoise_quality: str = "HIGH"


LADDER = tuple(TracedSamples(samples) for samples in (2, 4, 8, 16, 32, 64))
"""Candidates of full rendering by their cost."""


@dataclass(frozen=True)
class CropErrors:
    """Mean square errors of each view that was probed, in squares of grey values of 8 bits."""

    rendering: tuple[float, ...]
    jpeg: tuple[float, ...]
    """Error that JPEG adds to the same crops, which have the noise of the camera."""

    @property
    def ratio(self) -> float:
        return _ratio(sum(self.rendering), sum(self.jpeg))

    @property
    def worst_ratio(self) -> float:
        return max(_ratio(error, jpeg) for error, jpeg in zip(self.rendering, self.jpeg, strict=True))

    def record(self) -> ImageErrorRecord:
        """Return the facts for metadata.json."""
        return ImageErrorRecord(
            views=len(self.rendering), psnr_db=_psnr_dB(self.rendering), jpeg_psnr_db=_psnr_dB(self.jpeg)
        )

    @property
    def excess(self) -> float:
        """Ratio of the error to the largest one that is accepted."""
        return max(self.ratio / _MARGIN, self.worst_ratio / _WORST)


@dataclass(frozen=True)
class Decision:
    """The rendering of a run, with its error on the crops."""

    job_sha256: str
    hybrid: HybridSamples | None
    full: TracedSamples | None
    """One of the two is None."""
    errors: CropErrors

    def applied(self, sampling: TracingSettings) -> TracingSettings:
        """Return the settings of a job with those that were chosen."""
        if self.full is None:
            return replace(sampling, hybrid=self.hybrid, probe=False)
        chosen = self.full
        return replace(
            sampling,
            samples=chosen.samples,
            prefilter=chosen.prefilter,
            denoise_quality=chosen.denoise_quality,
            hybrid=None,
            probe=False,
        )


def probed_numbers(images: int) -> list[int]:
    """Return the indices of the images of a run of that length on whose crops errors are measured."""
    return np.unique(((np.arange(PROBE_VIEWS) + 0.5) / PROBE_VIEWS * images).astype(int)).tolist()


def _ratio(rendering: float, jpeg: float) -> float:
    """Return the ratio of two mean squares; JPEG has no error where an image is black, as beside a fisheye's circle."""
    return max(rendering, 0.0) / max(jpeg, _MIN_MEAN_SQUARE)


def _psnr_dB(mean_squares: tuple[float, ...]) -> float:
    mean = sum(mean_squares) / len(mean_squares)
    return round(10 * math.log10(255**2 / max(mean, _MIN_MEAN_SQUARE)), 1)


_DECISION = TypeAdapter(Decision)


def to_json(decision: Decision) -> bytes:
    return _DECISION.dump_json(decision, indent=1) + b"\n"


def read_decision(images: Path, job_sha256: str) -> Decision | None:
    """Return the decision about the images in a folder; None if there is none for this job."""
    path = images.with_name(PROBE)
    if not path.is_file():
        return None
    try:
        decision = _DECISION.validate_json(read_file(path, FileKind.JOB))
    except ValueError:
        return None
    return decision if decision.job_sha256 == job_sha256 else None


def is_decided(sampling: TracingSettings, images: Path, job_sha256: str) -> bool:
    """Return whether the settings of a job are known, because they are fixed or were chosen."""
    return not sampling.probe or read_decision(images, job_sha256) is not None


def decide(
    job_sha256: str,
    hybrid: HybridSamples | None,
    measure: Callable[[HybridSamples | TracedSamples], CropErrors],
) -> Decision:
    """Return the cheapest rendering with a small error; if no error is small, the rendering with the most samples.

    Args:
        job_sha256: SHA-256 of the job.
        hybrid: Samples of hybrid rendering; None where it is no candidate.
        measure: Measures the error of a candidate.
    """
    if hybrid is not None and (errors := measure(hybrid)).excess <= 1:
        return Decision(job_sha256, hybrid, None, errors)
    place, errors = 0, measure(LADDER[0])
    while errors.excess > 1 and place + 1 < len(LADDER):
        # Twice the samples at best halve the mean square error: a step that cannot do is not measured.
        place = min(place + math.ceil(math.log2(errors.excess)), len(LADDER) - 1)
        errors = measure(LADDER[place])
    return Decision(job_sha256, None, LADDER[place], errors)

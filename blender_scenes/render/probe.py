"""Choice of the cheapest rendering of a run whose errors are no larger than those of JPEG, from a few of its images.

Some looks need many more samples than others, and hybrid rendering is accurate enough under some looks only. So the
Blender process measures a few images of a run (`blender_side/measured_images.py`), and this module decides. The
measurement depends on the job alone, so all processes that share a run decide alike.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import NormalDist

import numpy as np
from pydantic import TypeAdapter
from typing_extensions import Self

from blender_scenes.render.image_errors import ImageError
from blender_scenes.render.sampling import HybridSamples, TracingSettings
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.documents.rendering_record import ImageErrorRecord

PROBE = "probe.json"
"""File beside the folder of the images, with the decision."""
_IMAGES_PER_VIEW, MIN_VIEWS, _MAX_VIEWS = 50, 4, 8
"""Length of a run for each image that is measured, and limits of their number."""
_SPREAD_DB, _SPREAD_WEIGHT = 1.0, 4
"""Standard deviation [dB] from image to image that is assumed beforehand, with the weight of so many images: that of
four images alone is too uncertain. The worst of five views was 0.6 to 2.0 dB below the mean under three looks (table
"Five views" of docs/rendering_measurements.md), 1.1 dB on average, and 1.2 standard deviations are expected."""
_QUANTILE = 1.85
"""95 % quantile of Student's t: 1.89 to 1.80 for the 7 to 11 degrees of freedom of four to eight images."""
_ERROR_PROBABILITY = 0.05
"""Probability with which a confidence limit of an error may be wrong."""
_MIN_MEAN_SQUARE = 0.01
"""Lower limit of a stated error, which the noise of the estimate may make negative."""
_MIN_RATIO = 0.1
"""Lower limit of the ratio to JPEG's error: it makes no difference how much smaller an error is, or how uncertain."""


@dataclass(frozen=True)
class TracedSamples:
    """A candidate of full rendering."""

    samples: int
    prefilter: str = "ACCURATE"
    denoise_quality: str = "HIGH"


REFERENCES, FIRST_SAMPLES, _MAX_SAMPLES = 4, 1, 128
"""Number of references of each image that is measured, and limits of the samples of each."""
_REFUSING_SAMPLES = 8
"""Samples of each reference with which a candidate may be refused. In two draws of `extreme` with rare bright pixels,
the errors from references of one sample were much larger than those from 8, so cheap candidates could be refused."""
LADDER = tuple(TracedSamples(samples) for samples in (2, 4, 8, 16, 32, 64))
"""Candidates of full rendering by their cost."""


_USUAL_SAMPLES = 4
"""Samples that hybrid rendering saves at least under most looks."""
Candidate = HybridSamples | TracedSamples


@dataclass(frozen=True)
class ImageErrors:
    """Mean square errors of each image that was measured, in squares of grey values of 8 bits."""

    rendering: tuple[float, ...]
    jpeg: tuple[float, ...]
    """Error that JPEG adds to the same images, which have the noise of the camera."""
    standard_error: tuple[float, ...]
    """Standard error of `rendering`."""
    error_probability: float = _ERROR_PROBABILITY
    """Probability with which the upper confidence limit of an error may be too small."""

    @classmethod
    def from_images(cls, errors: Iterable[ImageError]) -> Self:
        """Return the errors of images."""
        taken = list(errors)
        return cls(
            tuple(error.rendering for error in taken),
            tuple(error.jpeg for error in taken),
            tuple(error.standard_error for error in taken),
        )

    @classmethod
    def until_refused(cls, errors: Iterable[ImageError]) -> Self:
        """Return the errors up to the first image that is worse than its JPEG, with which a candidate is refused."""
        taken = []
        for error in errors:
            taken.append(error)
            if _ratio(error.rendering, error.jpeg) > 1:
                break
        return cls.from_images(taken)

    @property
    def relative_dB(self) -> tuple[float, ...]:
        """Return the error of each image relative to that of JPEG; negative where it is smaller."""
        ratios = (_ratio(error, jpeg) for error, jpeg in zip(self.rendering, self.jpeg, strict=True))
        return tuple(10 * math.log10(ratio) for ratio in ratios)

    @property
    def largest_dB(self) -> float:
        """Return the largest upper confidence limit of the errors, relative to those of JPEG.

        The estimate is unbiased, but where the references have rare bright pixels it is too small most of the time, and
        seldom much too large. So it counts for no more than their noise permits.
        """
        errors = zip(self.rendering, self.standard_error, self.jpeg, strict=True)
        quantile = NormalDist().inv_cdf(1 - self.error_probability)
        ratios = (_ratio(max(error, 0.0) + quantile * sd, jpeg) for error, sd, jpeg in errors)
        return 10 * math.log10(max(ratios))

    @property
    def limit_dB(self) -> float:
        """Return the error relative to JPEG's that a further image of the run exceeds with a probability of 5 %.

        It is the upper prediction limit for one more value of a normal distribution (Hahn and Meeker, Statistical
        Intervals, 1991, chapter 4), whose standard deviation is partly assumed beforehand; and never less than
        `largest_dB`.
        """
        relative_dB, count = np.array(self.relative_dB), len(self.rendering)
        squares = _SPREAD_WEIGHT * _SPREAD_DB**2 + np.sum((relative_dB - relative_dB.mean()) ** 2)
        variance = squares / (_SPREAD_WEIGHT + count - 1)
        predicted_dB = relative_dB.mean() + _QUANTILE * math.sqrt(variance * (1 + 1 / count))
        return float(max(predicted_dB, self.largest_dB))

    @property
    def lower_limits(self) -> Self:
        """Return the lower confidence limits (95 %) of the errors, without noise."""
        quantile = NormalDist().inv_cdf(1 - _ERROR_PROBABILITY)
        lower = (error - quantile * sd for error, sd in zip(self.rendering, self.standard_error, strict=True))
        return replace(self, rendering=tuple(lower), standard_error=(0.0,) * len(self.rendering))

    def scaled(self, factor: float) -> Self:
        """Return the errors times a factor, known as exactly as before: their noise is that of the references."""
        return replace(self, rendering=tuple(factor * error for error in self.rendering))

    def record(self) -> ImageErrorRecord:
        """Return the facts for metadata.json."""
        return ImageErrorRecord(
            views=len(self.rendering),
            psnr_db=_psnr_dB(self.rendering),
            jpeg_psnr_db=_psnr_dB(self.jpeg),
            relative_limit_db=round(self.limit_dB, 1),
        )

    @property
    def excess(self) -> float:
        """Return the ratio of the error to the largest one that is accepted."""
        return 10 ** (self.limit_dB / 10)


@dataclass(frozen=True)
class Decision:
    """The rendering of a run, with its errors."""

    job_sha256: str
    hybrid: HybridSamples | None
    full: TracedSamples | None
    """One of the two is None."""
    errors: ImageErrors
    reference_samples: int = FIRST_SAMPLES
    """Samples of each reference, when this candidate was measured."""

    def applied(self, sampling: TracingSettings) -> TracingSettings:
        """Return the settings of a job with those that were chosen."""
        chosen = self.full or self.hybrid
        return sampling if chosen is None else with_candidate(sampling, chosen)


def with_candidate(sampling: TracingSettings, candidate: Candidate) -> TracingSettings:
    """Return the settings of a job whose images are rendered as a candidate says."""
    if isinstance(candidate, HybridSamples):
        return replace(sampling, hybrid=candidate, probe=False)
    return replace(
        sampling,
        samples=candidate.samples,
        prefilter=candidate.prefilter,
        denoise_quality=candidate.denoise_quality,
        hybrid=None,
        probe=False,
    )


def probed_numbers(images: int) -> list[int]:
    """Return the indices of the images of a run of that length in which errors are measured."""
    views = min(max(images // _IMAGES_PER_VIEW, MIN_VIEWS), _MAX_VIEWS)
    return np.unique(((np.arange(views) + 0.5) / views * images).astype(int)).tolist()


def _ratio(rendering: float, jpeg: float) -> float:
    """Return the ratio of two mean squares; JPEG has no error where an image is black, as beside a fisheye's circle."""
    return max(rendering / max(jpeg, _MIN_MEAN_SQUARE), _MIN_RATIO)


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


Measure = Callable[[Candidate, int], ImageErrors]
"""Measures the errors of a candidate from references with so many samples each."""


def decide(job_sha256: str, hybrid: HybridSamples | None, images: int, measure: Measure) -> Decision:
    """Return the cheapest rendering with a small error; if no error is small, the rendering with the most samples.

    A candidate may be taken after references of few samples. Before it is refused, they get `_REFUSING_SAMPLES`, and
    more where their noise decides, as long as the run can save more than they cost.

    Args:
        job_sha256: SHA-256 of the job.
        hybrid: Samples of hybrid rendering; None where it is no candidate.
        images: Number of images of the run.
        measure: Measures the errors of a candidate.
    """
    measure = _tested_in_sequence(measure)
    samples = FIRST_SAMPLES
    if hybrid is not None:
        errors = measure(hybrid, samples)
        while _needs_more(samples, errors, images * _USUAL_SAMPLES):
            samples *= 2
            errors = measure(hybrid, samples)
        if errors.excess <= 1:
            return Decision(job_sha256, hybrid, None, errors, samples)
    place, errors = 0, measure(LADDER[0], samples)
    while errors.excess > 1 and place + 1 < len(LADDER):
        saved = LADDER[_first_small(errors, place)].samples - LADDER[place].samples
        if _needs_more(samples, errors, images * saved):
            samples *= 2
        else:
            place = _first_small(errors.lower_limits, place)
        errors = measure(LADDER[place], samples)
    return Decision(job_sha256, None, LADDER[place], errors, samples)


def _tested_in_sequence(measure: Measure) -> Measure:
    """Return a function that measures with stricter limits each time that a candidate is tested again.

    Its kth test has an error probability proportional to 1 / (k (k + 1)), and the sum over all tests bounds that of the
    choice (Bonferroni's inequality). Tests with few samples, which decide clear cases, thus get the largest share. A
    test that noise makes a candidate fail, whatever its error, uses nothing up.
    """
    tested: Candidate | None = None
    number = 1

    def measured(candidate: Candidate, samples: int) -> ImageErrors:
        nonlocal tested, number
        if candidate != tested:
            tested, number = candidate, 1
        errors = replace(measure(candidate, samples), error_probability=_error_probability(number))
        if errors.scaled(0.0).excess <= 1:
            number += 1
        return errors

    return measured


def _error_probability(test: int) -> float:
    """Return the error probability of a candidate's kth test, from 1; the sum over all is `_ERROR_PROBABILITY`."""
    return _ERROR_PROBABILITY / (test * (test + 1))


def _needs_more(samples: int, errors: ImageErrors, saved: int) -> bool:
    """Return whether the references need more samples before a candidate is refused; `saved` as for `_is_worth`."""
    if samples < _REFUSING_SAMPLES:
        return errors.excess > 1
    return _is_open(errors) and _is_worth(samples, errors, saved)


def _is_open(errors: ImageErrors) -> bool:
    """Return whether an error may be small but for the noise of the references."""
    return errors.lower_limits.excess <= 1 < errors.excess


def _is_worth(samples: int, errors: ImageErrors, saved: int) -> bool:
    """Return whether references with twice the samples cost no more than can be saved, in samples of an image."""
    return 2 * samples <= _MAX_SAMPLES and 2 * samples * REFERENCES * len(errors.rendering) <= saved


def _first_small(errors: ImageErrors, place: int) -> int:
    """Return the first step of the ladder beyond `place` with a small error, if twice the samples halve the errors.

    They do not do better, so no step before can do; the last one is returned if none can. It will be the first test.
    """
    errors = replace(errors, error_probability=_error_probability(1))
    steps = range(place + 1, len(LADDER) - 1)
    factors = ((step, LADDER[place].samples / LADDER[step].samples) for step in steps)
    return next((step for step, factor in factors if errors.scaled(factor).excess <= 1), len(LADDER) - 1)

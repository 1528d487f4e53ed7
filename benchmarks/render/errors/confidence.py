"""Whether the confidence of a choice of `render.method: auto` is what it should be, in synthetic noise of known size.

    python -m benchmarks.render.errors.confidence [--images 400] [--runs 1500]

The first table has the standard error of estimated errors for noise in parts of an image, relative to the standard
deviation of the estimates, and the share of upper limits of 95 % below the true error. In its last columns, some pixels
of the references are bright, and the image has lost the light of these, as a denoiser may do; the limits are those of
the choice, for which no error is negative. The second table has runs whose first
candidate, hybrid rendering, has in one of four images exactly the error of JPEG, in which it should be taken in at most
5 % of runs, or a smaller error in all four; and the samples that each reference gets. Nothing is rendered.
"""

import argparse
from collections.abc import Callable
from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from blender_scenes.render.image_errors import ImageError
from blender_scenes.render.probe import REFERENCES, Candidate, ImageErrors, decide
from blender_scenes.render.sampling import HybridSamples
from blender_scenes.render.standard_error import standard_error

SIZE = HEIGHT, WIDTH = 120, 160
PLACES = ("everywhere", "a tenth of the columns", "one block", "a small block", "from left to right")
KINDS = (
    (0.0, 0.0, 0.0),
    (1.2, 0.0, 0.0),
    (1.2, 0.0, 0.5),
    (0.8, 0.002, 0.0),
    *((0.8, share, (share / (1 - share)) ** 0.5) for share in (0.002, 0.01, 0.05)),
)
"""Blur [px], share of bright pixels, and the error of the image relative to the standard deviation of the noise."""
JPEG = 8.0
"""Mean square error [grey values^2]; any would do."""
RUN_IMAGES = 9999
"""Length of a run that is long enough for references of any number of samples."""
LIMIT = 1.645
"""95 % quantile of the standard normal distribution."""


def noise_sd(place: str) -> NDArray[np.float64]:
    """Return the standard deviation (H, W) of the noise."""
    sd = np.zeros(SIZE)
    if place == "everywhere":
        sd[:] = 1.0
    elif place == "a tenth of the columns":
        sd[:, 72:88] = 1.0
    elif place == "one block":
        sd[48:64, 72:88] = 1.0
    elif place == "a small block":
        sd[48:56, 72:80] = 1.0
    else:
        sd[:] = np.linspace(0.0, 2.0, WIDTH)
    return sd


def differences(
    random: np.random.Generator, place: str, blur_px: float, bright: float, relative_error: float
) -> list[NDArray[np.float32]]:
    """Return differences (H, W, 1) from references; a share `bright` of the pixels has all noise, if it is not 0."""
    sd, shape = noise_sd(place), (REFERENCES, *SIZE)
    white = ((random.random(shape) < bright) - bright) / (bright * (1 - bright)) ** 0.5 if bright else None
    noise = sd * (random.normal(size=shape) if white is None else white)
    if blur_px:
        noise = np.array([cv2.GaussianBlur(each, (0, 0), blur_px, borderType=cv2.BORDER_REFLECT) for each in noise])
    return [(each + relative_error * sd)[..., np.newaxis].astype(np.float32) for each in noise]


def print_standard_errors(images: int) -> None:
    print("noise, blur [px], share of bright pixels, error of the image: standard error, upper limits too low")
    random = np.random.Generator(np.random.PCG64(5))
    for place in PLACES:
        for blur_px, bright, relative_error in KINDS:
            drawn = [differences(random, place, blur_px, bright, relative_error) for _ in range(images)]
            estimates = np.array([_mean_product(np.array(each)) for each in drawn])
            errors = np.array([standard_error(each) for each in drawn])
            true = relative_error**2 * np.mean(noise_sd(place) ** 2)
            estimated = np.maximum(estimates, 0.0) if bright and relative_error else estimates
            low = np.mean(estimated + LIMIT * errors < true)
            ratio = errors.mean() / estimates.std()
            print(
                f"{place:24} {blur_px:3} {bright:5} {relative_error:5.3f}: {ratio:5.2f} {100 * low:5.1f} %", flush=True
            )


def _mean_product(values: NDArray[np.floating]) -> float:
    """Return the mean product over all pairs of values (K, ...)."""
    count = len(values)
    return float(np.mean(values.sum(axis=0) ** 2 - (values**2).sum(axis=0)) / (count * (count - 1)))


@dataclass
class SyntheticRun:
    """References of four images with independent values, whose noise gets smaller with their samples."""

    random: np.random.Generator
    relative_noise: float
    """Standard error with references of one sample, relative to JPEG's error."""
    relative_errors: tuple[float, ...]
    """Error of hybrid rendering in each image, relative to JPEG's; full rendering has nearly none."""
    values: int = 200
    samples: int = 0
    noise: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
    """(4, REFERENCES, values)."""

    def measure(self, candidate: Candidate, samples: int) -> ImageErrors:
        while self.samples < samples:
            traced = self.samples or 1
            variance = self.relative_noise * JPEG * (6 * self.values) ** 0.5 / traced
            new = self.random.normal(0.0, variance**0.5, (4, REFERENCES, self.values))
            self.noise = 0.5 * (self.noise + new) if self.samples else new
            self.samples += traced
        relative = self.relative_errors if isinstance(candidate, HybridSamples) else (0.02,) * 4
        signs = (-1) ** np.arange(self.values)
        errors = (
            self._error(noise + (JPEG * each) ** 0.5 * signs) for noise, each in zip(self.noise, relative, strict=True)
        )
        return (
            ImageErrors.until_refused(errors)
            if isinstance(candidate, HybridSamples)
            else ImageErrors.from_images(errors)
        )

    def _error(self, values: NDArray[np.float64]) -> ImageError:
        """Return the estimate with a standard error that is estimated too."""
        estimate, variance = _mean_product(values), float(values.var(axis=0, ddof=1).mean())
        squares = variance**2 / 6 + max(estimate, 0.0) * variance
        return ImageError(estimate, (squares / self.values) ** 0.5, JPEG)


def print_choices(runs: int) -> None:
    print("error of hybrid rendering, noise, both relative to JPEG's error: hybrid taken, mean samples of a reference")
    cases: list[tuple[str, tuple[float, ...]]] = [("at the limit", (1.0, 0.03, 0.03, 0.03))]
    cases += [("0.3", (0.3,) * 4), ("2", (2.0,) * 4)]
    for name, errors in cases:
        for noise in (0.1, 0.25, 0.5, 1.0, 2.0, 4.0):
            random = np.random.Generator(np.random.PCG64(11))
            taken = [_choice(SyntheticRun(random, noise, errors).measure) for _ in range(runs)]
            hybrid, samples = np.mean(np.array(taken, float), axis=0)
            print(f"{name:12} {noise:5}: {100 * hybrid:5.1f} % {samples:6.1f}", flush=True)


def _choice(measure: Callable[[Candidate, int], ImageErrors]) -> tuple[bool, int]:
    """Return whether hybrid rendering is taken, and the samples of each reference."""
    decision = decide("", HybridSamples(4, 2, 8), RUN_IMAGES, measure)
    return decision.hybrid is not None, decision.reference_samples


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--images", type=int, default=400, help="for each kind of noise")
    parser.add_argument("--runs", type=int, default=1500, help="for each error and noise")
    options = parser.parse_args()
    print_standard_errors(options.images)
    print_choices(options.runs)


if __name__ == "__main__":
    main()

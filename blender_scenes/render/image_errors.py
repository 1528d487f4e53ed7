"""Mean square error of an image, from references whose noise is independent, and that of its JPEG."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from sensors.camera.response import CameraResponse, compressed, develop_part
from symolo.core.arrays import FloatImage

_STEP = 1 / 16
"""Share of a difference over which the slope of the response is measured: so much less does its bend count. No
difference is larger than the range of grey values divided by twice the share, however bright a noisy pixel is."""
_REACH_PX = 12
"""Distance up to which the noise of two pixels is counted as correlated. A lens with a Gaussian spread of standard
deviation b leaves a correlation of exp(-(h / 2 b)^2) at a distance h, so this suffices up to 3 px."""


@dataclass(frozen=True)
class ImageError:
    """Mean square errors of an image, in squares of grey values of 8 bits."""

    rendering: float
    """Estimate; it may be negative where the error is small."""
    standard_error: float
    """Standard error of the estimate, from the noise of the references."""
    jpeg: float
    """Error that JPEG adds to the image with the noise of the camera."""


def image_error(
    light: FloatImage, references: Sequence[FloatImage], response: CameraResponse, metered: float, number: int
) -> ImageError:
    """Return the errors of an image and of its JPEG.

    Args:
        light: Linear light (H, W, 3) of the image, before the lens bends it.
        references: Two or more of the same, with other random numbers and without a denoiser.
        response: Response of the camera; only JPEG's error depends on its noise.
        metered: Median luminance of the run.
        number: Number of the frame, for the noise of the camera.
    """
    noisy = (develop_part(light, response, metered, number) + 0.5).astype(np.uint8)
    apart = compressed(noisy, response.jpeg_quality).astype(np.float32) - noisy
    differences = _differences(light, references, response, metered)
    error = np.mean(_products(differences), dtype=np.float64)
    return ImageError(float(error), _standard_error(differences), float(np.mean(apart**2, dtype=np.float64)))


def square_errors(
    light: FloatImage, references: Sequence[FloatImage], response: CameraResponse, metered: float
) -> FloatImage:
    """Return the square error (H, W, 3) of each grey value, for means over many of them; arguments as above.

    It is the mean product of the differences from two references, over all pairs of them. Their noise cancels in a mean
    over pixels, where the variance that it leaves is inversely proportional to the number of pairs.
    """
    return _products(_differences(light, references, response, metered))


def _products(differences: Sequence[FloatImage]) -> FloatImage:
    return np.mean([first * second for first, second in combinations(differences, 2)], axis=0)


def _standard_error(differences: Sequence[FloatImage]) -> float:
    """Return the standard error of the mean product over all pairs, for noise with the same statistics everywhere.

    A difference is e + n, with the error e of the image and noise n, whose covariance c(h) depends on the distance h of
    two pixels: lens, colour filter and noise reduction spread it over neighbours. In the mean over N pixels and the
    pairs of K references, the products of noise have the variance sum c^2 / (N K (K - 1) / 2), because those of
    different pairs are uncorrelated, and 2 e times the mean noise has the variance 4 sum(c g) / (N K), with the mean
    product g(h) of the errors of two pixels.

    Both are means over all pixels, because few samples show a rare bright pixel in few places, but it may be anywhere;
    two references that have it in the same place are too rare to be seen in the spread of the products. The noise of
    the three colours is taken to be the same.
    """
    height, width, colours = differences[0].shape
    count, values = len(differences), height * width * colours
    # Sums of products by distance, from spectra (theorem of Wiener and Khinchin); zeros keep borders from meeting.
    size = height + _REACH_PX, width + _REACH_PX
    spectra = np.fft.rfft2(np.asarray(differences, np.float64), size, axes=(1, 2))
    of_each = np.sum(np.abs(spectra) ** 2, axis=(0, 3))
    of_sum = np.sum(np.abs(spectra.sum(axis=0)) ** 2, axis=-1)
    near = np.ix_(*2 * [np.arange(-_REACH_PX, _REACH_PX + 1)])
    noise = np.fft.irfft2((of_each - of_sum / count) / (count - 1), size)[near] / values
    error = np.fft.irfft2((of_sum - of_each) / (count * (count - 1)), size)[near] / values
    variance = np.sum(2 / (count * (count - 1)) * noise**2) + max(4 / count * np.sum(noise * error), 0.0)
    return math.sqrt(variance / (height * width))


def _differences(
    light: FloatImage, references: Sequence[FloatImage], response: CameraResponse, metered: float
) -> list[FloatImage]:
    calm = replace(response, shot_noise=0.0, read_noise=0.0)
    return [_difference(light, reference, calm, metered) for reference in references]


def _difference(light: FloatImage, reference: FloatImage, response: CameraResponse, metered: float) -> FloatImage:
    """Return the difference in grey values (H, W, 3), by the slope of the response at the image.

    The mean of the grey values of a noisy reference is too dark, because the tone curve is bent. The slope belongs to
    the image alone, so the noise of the reference keeps a mean of zero.
    """
    step = np.float32(_STEP) * (reference - light)
    up, down = (develop_part(np.maximum(each, 0), response, metered, None) for each in (light + step, light - step))
    return (up - down) / (2 * _STEP)

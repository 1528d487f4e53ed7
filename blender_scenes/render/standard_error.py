"""Standard error of a mean square error that is estimated from references whose noise is independent."""

import math
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import FloatImage

_REACH_PX = 12
"""Distance up to which the noise of two pixels is counted as correlated. A lens with a Gaussian spread of standard
deviation b leaves a correlation of exp(-(h / 2 b)^2) at a distance h, so this suffices up to 3 px."""
_RINGS_PX = (5, 7), (9, 13), (17, 25)
"""Sides of the squares around a pixel between which its neighbours have about the same variance of noise as itself, but
noise that a lens hardly correlates with its own. The wider ones have other bright pixels where these are rare."""


def standard_error(differences: Sequence[FloatImage]) -> float:
    """Return the standard error of the mean product over all pairs of differences (H, W, 3).

    A difference is e + n, with the error e of the image and noise n. The noise has the variance v at a pixel and the
    correlation r(h) at a distance h, because lens, colour filter and noise reduction spread it over neighbours. In the
    mean over N pixels and the pairs of K references, the products of noise have the variance
    mean(v^2) sum(r^2) / (N K (K - 1) / 2), because those of different pairs are uncorrelated. And 2 e times the mean
    noise has the variance 4 sum(r g) / (N K), with the mean product g(h) of the values of e sqrt(v) at two pixels.

    Few samples show a rare bright pixel in few places, but it may be anywhere; two references that have it in the same
    place are too rare to be seen in the spread of the products. So the variance of the noise is estimated, and its
    square is never less than for noise that is alike in the whole image. The noise of the three colours is taken to be
    the same.
    """
    values = np.asarray(differences, np.float64)
    count, height, width, _ = values.shape
    noise, _ = _covariances(values)
    variance = values.var(axis=0, ddof=1).mean(axis=-1)
    mean = variance.mean()
    if mean == 0:
        return 0.0
    # The square of a noisy estimate would be too large; the product of estimates at neighbouring pixels is not.
    products = (float(np.mean(variance * _mean_in_ring(variance, ring))) for ring in _RINGS_PX)
    unevenness = max(*products, mean**2) / mean**2
    nearby = _sum_around(variance, _RINGS_PX[0][0])
    relative = nearby / nearby.mean()
    _, error = _covariances(values * np.sqrt(relative)[..., np.newaxis])
    total = unevenness * 2 / (count * (count - 1)) * np.sum(noise**2) + max(4 / count * np.sum(noise * error), 0.0)
    return math.sqrt(total / (height * width))


def _covariances(values: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the mean products of the noise of two pixels, and of their errors, by distance, from values (K, H, W, 3).

    They come from spectra (theorem of Wiener and Khinchin); zeros keep borders from meeting.
    """
    count, height, width, colours = values.shape
    size = [cv2.getOptimalDFTSize(length + _REACH_PX) for length in (height, width)]
    spectra = np.fft.rfft2(values, size, axes=(1, 2))
    power_of_each = np.sum(np.abs(spectra) ** 2, axis=(0, 3))
    power_of_sum = np.sum(np.abs(spectra.sum(axis=0)) ** 2, axis=-1)
    near = np.ix_(*2 * [np.arange(-_REACH_PX, _REACH_PX + 1)])
    noise = np.fft.irfft2((power_of_each - power_of_sum / count) / (count - 1), size)[near]
    error = np.fft.irfft2((power_of_sum - power_of_each) / (count * (count - 1)), size)[near]
    return noise / (height * width * colours), error / (height * width * colours)


def _mean_in_ring(values: NDArray[np.float64], sides_px: tuple[int, int]) -> NDArray[np.float64]:
    """Return the mean around each pixel, between an inner and an outer square."""
    inner, outer = sides_px
    return (_sum_around(values, outer) - _sum_around(values, inner)) / (outer**2 - inner**2)


def _sum_around(values: NDArray[np.float64], side_px: int) -> NDArray[np.float64]:
    """Return the sum over a square around each pixel; the image is mirrored at its borders."""
    # The running sums of OpenCV may leave tiny negative values.
    return np.maximum(cv2.boxFilter(values, -1, (side_px, side_px), normalize=False), 0.0)

"""Light that a denoiser removes from an image, together with its noise."""

import numpy as np

from sensors.camera.colour import LUMINANCE
from symolo.core.arrays import FloatImage


def lost_light_factor(noisy: FloatImage, denoised: FloatImage) -> float:
    """Return the factor that gives denoised pixels (..., 3) the mean luminance of the noisy ones, or nearly so.

    Path tracing has the right mean, but with few samples much of it may be in few bright pixels. A denoiser takes them
    for noise, so its image is too dark everywhere. The mean difference d of both images shows this, with a standard
    error s that follows from its spread over the pixels. Only the share 1 - s^2 / d^2 of it counts (the weight of a
    Wiener filter), and none where d is less than s, so a single bright pixel changes nothing: its d is equal to its s.
    A single pixel has no spread, and keeps its light.
    """
    before = denoised @ LUMINANCE
    mean = float(np.mean(before, dtype=np.float64))
    removed = (noisy @ LUMINANCE - before).astype(np.float64)
    if mean <= 0 or removed.size < 2 or not np.isfinite(removed).all():
        return 1.0
    difference, variance = float(removed.mean()), float(removed.var(ddof=1)) / removed.size
    if difference**2 <= variance:
        return 1.0
    return 1.0 + (difference - variance / difference) / mean

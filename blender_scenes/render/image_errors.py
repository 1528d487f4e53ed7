"""Mean square error of an image, from references whose noise is independent, and that of its JPEG."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from blender_scenes.render.standard_error import standard_error
from sensors.camera.response import CameraResponse, compressed, develop_part
from symolo.core.arrays import FloatImage

_STEP = 1 / 16
"""Share of a difference over which the slope of the response is measured: so much less does its bend count. No
difference is larger than the range of grey values divided by twice the share, however bright a noisy pixel is."""


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
    differences = reference_differences(light, references, response, metered)
    error = np.mean(_products(differences), dtype=np.float64)
    return ImageError(float(error), standard_error(differences), float(np.mean(apart**2, dtype=np.float64)))


def square_errors(
    light: FloatImage, references: Sequence[FloatImage], response: CameraResponse, metered: float
) -> FloatImage:
    """Return the square error (H, W, 3) of each grey value, for means over many of them; arguments as above.

    It is the mean product of the differences from two references, over all pairs of them. Their noise cancels in a mean
    over pixels, where the variance that it leaves is inversely proportional to the number of pairs.
    """
    return _products(reference_differences(light, references, response, metered))


def _products(differences: Sequence[FloatImage]) -> FloatImage:
    return np.mean([first * second for first, second in combinations(differences, 2)], axis=0)


def reference_differences(
    light: FloatImage, references: Sequence[FloatImage], response: CameraResponse, metered: float
) -> list[FloatImage]:
    """Return the difference in grey values (H, W, 3) from each reference, by the slope of the response at the image."""
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

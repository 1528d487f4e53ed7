"""Mean square error of an image, from two references whose noise is independent, and that of its JPEG."""

from dataclasses import replace

import numpy as np

from sensors.camera.response import CameraResponse, compressed, develop_part
from symolo.core.arrays import FloatImage

_STEP = 1 / 16
"""Share of a difference over which the slope of the response is measured: so much less does its bend count."""


def mean_square_errors(
    light: FloatImage, references: tuple[FloatImage, FloatImage], response: CameraResponse, metered: float, number: int
) -> tuple[float, float]:
    """Return the mean square errors of an image and of its JPEG, in squares of grey values of 8 bits.

    The first may be negative where the error is small.

    Args:
        light: Linear light (H, W, 3) of the image, before the lens bends it.
        references: The same with other random numbers and without a denoiser.
        response: Response of the camera; only JPEG's error depends on its noise.
        metered: Median luminance of the run.
        number: Number of the frame, for the noise of the camera.
    """
    noisy = (develop_part(light, response, metered, number) + 0.5).astype(np.uint8)
    apart = compressed(noisy, response.jpeg_quality).astype(np.float32) - noisy
    error = np.mean(square_errors(light, references, response, metered), dtype=np.float64)
    return float(error), float(np.mean(apart**2, dtype=np.float64))


def square_errors(
    light: FloatImage, references: tuple[FloatImage, FloatImage], response: CameraResponse, metered: float
) -> FloatImage:
    """Return the square error (H, W, 3) of each grey value, for means over many of them; arguments as above.

    It is the product of the differences from both references, whose noise cancels in a mean.
    """
    calm = replace(response, shot_noise=0.0, read_noise=0.0)
    first, second = (_difference(light, reference, calm, metered) for reference in references)
    return first * second


def _difference(light: FloatImage, reference: FloatImage, response: CameraResponse, metered: float) -> FloatImage:
    """Return the difference in grey values (H, W, 3), by the slope of the response at the image.

    The mean of the grey values of a noisy reference is too dark, because the tone curve is bent. The slope belongs to
    the image alone, so the noise of the reference keeps a mean of zero.
    """
    step = np.float32(_STEP) * (reference - light)
    up, down = (develop_part(np.maximum(each, 0), response, metered, None) for each in (light + step, light - step))
    return (up - down) / (2 * _STEP)

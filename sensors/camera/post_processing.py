"""Last steps inside a camera, on finished grey values: noise reduction and sharpening."""

import cv2
import numpy as np

from symolo.core.arrays import FloatImage

_LUMA = np.array([0.299, 0.587, 0.114], np.float32)
"""Weights of gamma-coded components (ITU-R BT.601), as in JPEG."""


def denoised(image: FloatImage, contrast: float, colour_blur_px: float) -> FloatImage:
    """Return an image (H, W, 3), 0 to 1, with less noise and less fine texture.

    Luma is smoothed along lines through five or three pixels, by the minimum mean square error of Lee, Refined
    filtering of image noise using local statistics (1981): where the standard deviation along a line is far below
    `contrast`, the result is the mean of the line; where it is far above, the pixel stays. Of eight lines, those count
    most that vary least, so that an edge is smoothed along itself. The differences of the components from the luma are
    blurred everywhere, since the eye does not see fine colour.

    Args:
        image: Grey values.
        contrast: Standard deviation, 0 to 1, of which half is kept; 0 leaves luma as it is.
        colour_blur_px: Standard deviation of the blur of colours; 0 leaves them as they are.
    """
    if contrast == 0 and colour_blur_px == 0:
        return image
    luma = image @ _LUMA
    colour = image - luma[..., None]
    if colour_blur_px > 0:
        colour = cv2.GaussianBlur(colour, (0, 0), colour_blur_px)
    return (_smoothed(luma, contrast)[..., None] + colour).astype(np.float32)


def _smoothed(luma: FloatImage, contrast: float) -> FloatImage:
    if contrast == 0:
        return luma
    # The mean is taken off first, for the precision of the variance.
    level, noise_variance = luma.mean(dtype=np.float64).astype(np.float32), np.float32(contrast**2)
    apart = luma - level
    square, total, weights = apart * apart, np.zeros_like(luma), np.zeros_like(luma)
    for line in _LINES:
        mean = cv2.filter2D(apart, cv2.CV_32F, line)
        variance = np.maximum(cv2.filter2D(square, cv2.CV_32F, line) - mean * mean, 0)
        share = noise_variance / (variance + noise_variance)
        weight = share * share
        total += weight * (apart + share * (mean - apart))
        weights += weight
    return total / weights + level


def _line(step_x: int, step_y: int) -> FloatImage:
    """Return the weights (5, 5) of the mean of the pixels on a line through the middle one."""
    at = range(-2, 3) if max(abs(step_x), abs(step_y)) == 1 else range(-1, 2)
    weights = np.zeros((5, 5), np.float32)
    for k in at:
        weights[2 + k * step_y, 2 + k * step_x] = 1 / len(at)
    return weights


_LINES = tuple(_line(*step) for step in ((1, 0), (2, 1), (1, 1), (1, 2), (0, 1), (-1, 2), (-1, 1), (-2, 1)))
"""Eight lines. They pass through middles of pixels only, since interpolation across an edge would count as variance."""


def sharpened(image: FloatImage, strength: float, radius_px: float) -> FloatImage:
    """Apply an unsharp mask to the luma, so that edges keep their colour, and clip to 0 to 1."""
    if strength == 0:
        return image
    grey = image @ _LUMA
    detail = grey - cv2.GaussianBlur(grey, (0, 0), radius_px)
    return np.clip(image + np.float32(strength) * detail[..., None], 0, 1).astype(np.float32)

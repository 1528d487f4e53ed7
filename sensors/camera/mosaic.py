"""A sensor under a Bayer filter: one colour at each pixel, and the interpolation of the other two.

The interpolation is linear, by filters of 5 x 5 pixels: Malvar, He and Cutler, High-quality linear interpolation for
demosaicing of Bayer-patterned color images, ICASSP 2004, Fig. 2. Noise that is independent from pixel to pixel is
afterwards shared between neighbours and between colours, as that of a real camera.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import FloatImage

_COLOUR_AT = np.array([[0, 1], [1, 2]])
"""Colour of each pixel of a block of 2 x 2: red, green; green, blue."""
_GREEN = np.array([[0, 0, -1, 0, 0], [0, 0, 2, 0, 0], [-1, 2, 4, 2, -1], [0, 0, 2, 0, 0], [0, 0, -1, 0, 0]], np.float32)
"""Green at a red or blue pixel, in eighths."""
_ALONG = np.array(
    [[0, 0, 0.5, 0, 0], [0, -1, 0, -1, 0], [-1, 4, 5, 4, -1], [0, -1, 0, -1, 0], [0, 0, 0.5, 0, 0]], np.float32
)
"""Red or blue at a green pixel with this colour on its left and right, in eighths."""
_ACROSS = np.array(
    [[0, 0, -1.5, 0, 0], [0, 2, 0, 2, 0], [-1.5, 0, 6, 0, -1.5], [0, 2, 0, 2, 0], [0, 0, -1.5, 0, 0]], np.float32
)
"""Red at a blue pixel or blue at a red one, in eighths."""


def mosaic(light: FloatImage) -> FloatImage:
    """Return the colour (H, W) of light (H, W, 3) that reaches each pixel through its filter."""
    return np.take_along_axis(light, colours(*light.shape[:2])[..., None], axis=2)[..., 0]


def colours(height: int, width: int) -> NDArray[np.int64]:
    """Return the colour (H, W) of each pixel's filter: 0 red, 1 green, 2 blue."""
    return np.tile(_COLOUR_AT, (-(-height // 2), -(-width // 2)))[:height, :width]


def demosaiced(sensor: FloatImage) -> FloatImage:
    """Return the colours (H, W, 3) interpolated from the sensor's values (H, W)."""
    kernels = (_GREEN, _ALONG, _ALONG.T, _ACROSS)
    green, along, above_and_below, across = (_filtered(sensor, kernel) for kernel in kernels)
    image = np.empty((*sensor.shape, 3), np.float32)
    image[..., 0] = image[..., 1] = image[..., 2] = sensor
    for row, column in ((0, 0), (1, 1)):
        here = (slice(row, None, 2), slice(column, None, 2))
        image[(*here, 1)] = green[here]
        image[(*here, 2 - 2 * row)] = across[here]
    # A green pixel has the colour of its row's other pixels beside it, and the third one above and below.
    for row, column in ((0, 1), (1, 0)):
        here = (slice(row, None, 2), slice(column, None, 2))
        image[(*here, 2 * row)] = along[here]
        image[(*here, 2 - 2 * row)] = above_and_below[here]
    return image


def _filtered(sensor: FloatImage, eighths: FloatImage) -> FloatImage:
    # Mirroring about the border pixel keeps the pattern of colours.
    filtered = cv2.filter2D(sensor, cv2.CV_32F, eighths / 8.0, borderType=cv2.BORDER_REFLECT_101)
    return filtered.astype(np.float32, copy=False)

"""PNG and JPEG images: complete, of limited size, as 8-bit sRGB in their EXIF orientation."""

import cv2
import numpy as np
from numpy.typing import NDArray

from configs.assets.decoding import decoded
from symolo.core.files.image_decoder import COLOUR
from symolo.core.files.image_headers import JPEG, image_size

MAX_BYTES = 64 << 20
MAX_PIXELS = 64_000_000
MAX_SIDE_PX = 4096
"""Longest side after averaging down; cameras seldom resolve the floor finer than a quarter of a millimetre."""

Bytes = NDArray[np.uint8]

_s = np.arange(256) / 255
LINEAR = np.where(_s <= 0.04045, _s / 12.92, ((_s + 0.055) / 1.055) ** 2.4)
"""(256,), linear value of each sRGB component (IEC 61966-2-1)."""


def read_image(data: bytes) -> Bytes:
    """Return the image of a file, averaged down to `MAX_SIDE_PX`."""
    return averaged_down(whole_image(data))


def whole_image(data: bytes) -> Bytes:
    """Return the image (H, W, 3), sRGB, of a file's bytes in its EXIF orientation, first row at the top; no opacity.

    Raises:
        ValueError: Neither PNG nor JPEG, too large, cut short or damaged.
    """
    width, height = image_size(data, MAX_PIXELS)
    image = decoded(data, COLOUR, (width, height), is_strict=data.startswith(JPEG))
    return np.asarray(image[..., ::-1], np.uint8)


def averaged_down(image: Bytes) -> Bytes:
    shrunk = MAX_SIDE_PX / max(image.shape[:2])
    if shrunk < 1:
        size = [max(1, round(side * shrunk)) for side in image.shape[1::-1]]
        return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8)
    return np.ascontiguousarray(image)


def mean_of(image: Bytes) -> tuple[float, float, float]:
    """Return the mean linear colour of an sRGB image (H, W, 3); white is 1."""
    counts = (np.bincount(image[..., channel].ravel(), minlength=256) for channel in range(3))
    red, green, blue = (float(count @ LINEAR) / image[..., 0].size for count in counts)
    return red, green, blue

"""Upsampling of light from few pixels to the pixels of an image.

Kopf et al., Joint bilateral upsampling (2007): a pixel takes its value from those of the four nearest light pixels that
lie on the same surface.
"""

import numpy as np

from symolo.core.arrays import FloatImage

_DEPTH_SHARE = 0.05
"""Difference of two pixels' depths, as a share of the depth, for which their weight is 1/e."""
_NORMAL_POWER = 16
_MIN_WEIGHT = np.float32(1e-4)
"""Minimum weight, so that a pixel without a similar neighbour takes the mean of all."""


def reduced(image: FloatImage, times: int) -> FloatImage:
    """Return the means (H / times, W / times, K) of squares of pixels."""
    height, width, channels = image.shape
    squares = image.reshape(height // times, times, width // times, times, channels)
    return squares.mean(axis=(1, 3), dtype=np.float32)


def upsampled(low: FloatImage, nearness: FloatImage, normal: FloatImage) -> FloatImage:
    """Return (H, W, K) from (H / times, W / times, K) for an integer number of times.

    Args:
        low: Light of few pixels.
        nearness: (H, W, 1) inverse depth of the image's surfaces [1/m].
        normal: (H, W, 3) normals of the surfaces; (0, 0, 0) where there is none.
    """
    guide = np.concatenate([nearness, normal], axis=-1)
    times = len(guide) // len(low)
    if times == 1:
        return low
    padded, around = (np.pad(a, ((1, 1), (1, 1), (0, 0)), mode="edge") for a in (low, reduced(guide, times)))
    height, width, channels = low.shape
    out = np.empty((times * height, times * width, channels), np.float32)
    # All final pixels at the same place within their light pixel have the same neighbours and are computed at once.
    for down in range(times):
        for right in range(times):
            pixels = guide[down::times, right::times]
            total, weights = np.zeros_like(low), np.zeros((height, width, 1), np.float32)
            for dy, near_y in _neighbours(down, times):
                for dx, near_x in _neighbours(right, times):
                    neighbours = slice(dy, dy + height), slice(dx, dx + width)
                    weight = np.float32(near_y * near_x) * (_similarity(pixels, around[neighbours]) + _MIN_WEIGHT)
                    total += weight * padded[neighbours]
                    weights += weight
            out[down::times, right::times] = total / weights
    return out


def _neighbours(place: int, times: int) -> list[tuple[int, float]]:
    """Return the offsets, in a padded image, of the two pixels nearest to a small one, and their linear weights."""
    away = (place + 0.5) / times - 0.5
    return [(1, 1 - abs(away)), (2 if away > 0 else 0, abs(away))]


def _similarity(a: FloatImage, b: FloatImage) -> FloatImage:
    apart = np.abs(a[..., :1] - b[..., :1]) / (_DEPTH_SHARE * np.maximum(a[..., :1], _MIN_WEIGHT))
    along = np.maximum((a[..., 1:] * b[..., 1:]).sum(axis=-1, keepdims=True), 0)
    return np.exp(-apart) * along**_NORMAL_POWER

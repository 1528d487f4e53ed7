"""Light of fewer pixels, brought to a picture's own.

Kopf et al., Joint bilateral upsampling (2007): a pixel takes from those of the four nearest that lie on its surface.
"""

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.float32]

_DEPTH_SHARE = 0.05
"""Apart by this share of the depth, two pixels have 1/e to do with each other."""
_NORMAL_POWER = 16
_LEAST = np.float32(1e-4)
"""Of a weight, so that a pixel without a like one takes from all."""


def reduced(image: Image, times: int) -> Image:
    """(H / times, W / times, K) means of squares."""
    height, width, channels = image.shape
    squares = image.reshape(height // times, times, width // times, times, channels)
    return squares.mean(axis=(1, 3), dtype=np.float32)


def upsampled(low: Image, nearness: Image, normal: Image) -> Image:
    """(H, W, K) from (H / times, W / times, K) for a whole number of times.

    Args:
        low: The light.
        nearness: (H, W, 1) of the picture's surfaces, the inverse of their depth [1/m].
        normal: (H, W, 3) of them; (0, 0, 0) where there is none.
    """
    guide = np.concatenate([nearness, normal], axis=-1)
    times = len(guide) // len(low)
    if times == 1:
        return low
    padded, around = (np.pad(a, ((1, 1), (1, 1), (0, 0)), mode="edge") for a in (low, reduced(guide, times)))
    height, width, channels = low.shape
    out = np.empty((times * height, times * width, channels), np.float32)
    for down in range(times):
        for right in range(times):
            own = guide[down::times, right::times]
            total, weights = np.zeros_like(low), np.zeros((height, width, 1), np.float32)
            for dy, near_y in _neighbours(down, times):
                for dx, near_x in _neighbours(right, times):
                    there = slice(dy, dy + height), slice(dx, dx + width)
                    weight = np.float32(near_y * near_x) * (_alike(own, around[there]) + _LEAST)
                    total += weight * padded[there]
                    weights += weight
            out[down::times, right::times] = total / weights
    return out


def _neighbours(place: int, times: int) -> list[tuple[int, float]]:
    """Where in a padded picture the two nearest to a small pixel begin, and their shares of linear interpolation."""
    away = (place + 0.5) / times - 0.5
    return [(1, 1 - abs(away)), (2 if away > 0 else 0, abs(away))]


def _alike(a: Image, b: Image) -> Image:
    apart = np.abs(a[..., :1] - b[..., :1]) / (_DEPTH_SHARE * np.maximum(a[..., :1], _LEAST))
    along = np.maximum((a[..., 1:] * b[..., 1:]).sum(axis=-1, keepdims=True), 0)
    return np.exp(-apart) * along**_NORMAL_POWER

"""Light of half as many pixels each way, brought to a picture's own.

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


def halved(image: Image) -> Image:
    """(H/2, W/2, K) means of squares of four."""
    height, width, channels = image.shape
    return image.reshape(height // 2, 2, width // 2, 2, channels).mean(axis=(1, 3), dtype=np.float32)


def upsampled(low: Image, nearness: Image, normal: Image) -> Image:
    """(H, W, K) from (H/2, W/2, K).

    Args:
        low: The light.
        nearness: (H, W, 1) of the picture's surfaces, the inverse of their depth [1/m].
        normal: (H, W, 3) of them; (0, 0, 0) where there is none.
    """
    guide = np.concatenate([nearness, normal], axis=-1)
    padded, around = (np.pad(a, ((1, 1), (1, 1), (0, 0)), mode="edge") for a in (low, halved(guide)))
    height, width, channels = low.shape
    out = np.empty((2 * height, 2 * width, channels), np.float32)
    for down in (0, 1):
        for right in (0, 1):
            own = guide[down::2, right::2]
            total, weights = np.zeros_like(low), np.zeros((height, width, 1), np.float32)
            for dy, near_y in ((1, 0.75), (2 * down, 0.25)):
                for dx, near_x in ((1, 0.75), (2 * right, 0.25)):
                    there = slice(dy, dy + height), slice(dx, dx + width)
                    weight = np.float32(near_y * near_x) * (_alike(own, around[there]) + _LEAST)
                    total += weight * padded[there]
                    weights += weight
            out[down::2, right::2] = total / weights
    return out


def _alike(a: Image, b: Image) -> Image:
    apart = np.abs(a[..., :1] - b[..., :1]) / (_DEPTH_SHARE * np.maximum(a[..., :1], _LEAST))
    along = np.maximum((a[..., 1:] * b[..., 1:]).sum(axis=-1, keepdims=True), 0)
    return np.exp(-apart) * along**_NORMAL_POWER

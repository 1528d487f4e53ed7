"""Values of a small image as linear functions of a guide, for a larger image whose guide is known.

He, Sun, Tang, Guided Image Filtering, IEEE Trans. Pattern Anal. Mach. Intell. 35(6), 2013; here with weights.
"""

import cv2
import numpy as np

from symolo.core.arrays import FloatImage

_SPREAD_PX = 1.5
"""Standard deviation of a pixel's neighbourhood."""
_NEAREST_PX = 0.75
"""The same where only the nearest pixels matter."""
_CARRIED_PX = 1.0
"""The same where light is carried over the pixels that a filter of 3 px spreads an edge over."""
_MIN_VARIANCE = np.float32(1e-4)
"""Variance of the guide below which values do not follow it."""
_MIN_WEIGHT = np.float32(1e-3)


def local_lines(values: FloatImage, guide: FloatImage, weight: FloatImage) -> FloatImage:
    """Return (H, W, 2 K): the slope of the values around each pixel over the guide, and the line's value at its guide.

    Args:
        values: (H, W, K).
        guide: (H, W, 1), from 0 to 1.
        weight: (H, W, 1), weight of each pixel; without any weight around, the slope is 0 and the value the pixel's.
    """
    channels = values.shape[-1]
    moments = np.concatenate([weight, guide * weight, guide**2 * weight, values * weight, guide * values * weight], -1)
    around = cv2.GaussianBlur(moments, (0, 0), _SPREAD_PX, borderType=cv2.BORDER_REPLICATE)
    total = around[..., :1]
    means = around[..., 1:] / np.maximum(total, _MIN_WEIGHT)
    mean, square, mean_values, product = np.split(means, [1, 2, 2 + channels], axis=-1)
    # Weighted least squares around each pixel: the slope is covariance by variance. The added variance makes it 0
    # where the guide is constant.
    slope = (product - mean * mean_values) / (np.maximum(square - mean**2, 0) + _MIN_VARIANCE)
    known = total > _MIN_WEIGHT
    return np.concatenate(
        [np.where(known, slope, 0), np.where(known, mean_values + slope * (guide - mean), values)], -1
    )


def no_brighter_than_around(light: FloatImage, known: FloatImage) -> FloatImage:
    """Return light (H, W, K), at most as bright as the nearest known pixels where `known` (H, W, 1) is not 1.

    It may be darker: a foot is in the shade of what stands on it, and the more so the nearer it is.
    """
    around, is_near = _nearest(light, known, _NEAREST_PX)
    return np.where((known < 1) & is_near, np.minimum(light, around), light)


def carried_from_around(light: FloatImage, known: FloatImage) -> FloatImage:
    """Return light (H, W, K) that is that of the nearest known pixels where `known` (H, W, 1) is not 1.

    Without a known pixel nearby, it is left as it is.
    """
    around, is_near = _nearest(light, known, _CARRIED_PX)
    return np.where((known < 1) & is_near, around, light)


def _nearest(light: FloatImage, known: FloatImage, spread_px: float) -> tuple[FloatImage, np.ndarray]:
    """Return the mean light (H, W, K) of the nearest known pixels, and whether there are any (H, W, 1)."""
    moments = np.concatenate([light * known, known], axis=-1)
    around, weight = np.split(cv2.GaussianBlur(moments, (0, 0), spread_px, borderType=cv2.BORDER_REPLICATE), [-1], -1)
    return around / np.maximum(weight, _MIN_WEIGHT), weight > _MIN_WEIGHT

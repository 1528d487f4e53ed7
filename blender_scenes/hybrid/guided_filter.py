"""Values that follow a guide, told as lines: what a picture of few pixels says of one of many.

He, Sun, Tang, Guided Image Filtering, IEEE Trans. Pattern Anal. Mach. Intell. 35(6), 2013; weighted here.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.float32]

_SPREAD_PX = 1.5
"""Standard deviation of what is around a pixel."""
_MIN_VARIANCE = np.float32(1e-4)
"""Of the guide: where it varies less, values are taken not to follow it."""
_MIN_WEIGHT = np.float32(1e-3)


def local_lines(values: Image, guide: Image, weight: Image) -> Image:
    """(H, W, 2 K): slopes by which the values around each pixel follow the guide, and where the lines are at its own.

    Args:
        values: (H, W, K).
        guide: (H, W, 1), in 0 to 1.
        weight: (H, W, 1), what each pixel counts for; where nothing around does, slopes are 0 and lines at its values.
    """
    channels = values.shape[-1]
    moments = np.concatenate([weight, guide * weight, guide**2 * weight, values * weight, guide * values * weight], -1)
    around = cv2.GaussianBlur(moments, (0, 0), _SPREAD_PX, borderType=cv2.BORDER_REPLICATE)
    total = around[..., :1]
    means = around[..., 1:] / np.maximum(total, _MIN_WEIGHT)
    mean, square, of_values, product = np.split(means, [1, 2, 2 + channels], axis=-1)
    slope = (product - mean * of_values) / (np.maximum(square - mean**2, 0) + _MIN_VARIANCE)
    told = total > _MIN_WEIGHT
    return np.concatenate([np.where(told, slope, 0), np.where(told, of_values + slope * (guide - mean), values)], -1)

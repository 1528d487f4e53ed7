"""Light on the floor out of samples with noise, beside the bodies that stand on it."""

import cv2
import numpy as np

from blender_scenes.hybrid.denoiser import Denoiser
from blender_scenes.render.lost_light import lost_light_factor
from symolo.core.arrays import FloatImage

_MIN_FREE = np.float32(0.5)
"""Share of a texel beside a body below which the light there is taken from a neighbour."""
_GUIDE_ALBEDO = np.float32(0.5)
"""Albedo of the floor as a guide of the denoiser. With a white floor beside black bodies, the denoised light has
coloured fringes at their feet."""
_UP = np.array((0.0, 0.0, 1.0), np.float32)


def without_noise(light: FloatImage, free: FloatImage, denoised: Denoiser, *, keeps_mean: bool = False) -> FloatImage:
    """Return light (N, N, 3) on the whole floor, without noise.

    Args:
        light: Light on a floor that is black below bodies.
        free: Share (N, N, 1) of each texel that is not below a body.
        denoised: Denoiser. It gets the floor below bodies as black: so light does not spread from one side of a wall to
            the other, and the shadow at a foot keeps its shape.
        keeps_mean: Whether the light that is not below bodies gets its mean back, of which the denoiser takes a part
            for noise. The ratio of two lights does not need it, because both lose about the same part.
    """
    albedo = np.broadcast_to(_GUIDE_ALBEDO * free, light.shape)
    even = denoised(light, np.broadcast_to(_UP, light.shape), albedo)
    known = free[..., 0] > _MIN_FREE
    if keeps_mean and known.any():
        even *= np.float32(lost_light_factor(light[known], even[known]))
    return without_holes(even, free)


def without_holes(light: FloatImage, free: FloatImage) -> FloatImage:
    """Return light (N, N, K) on the whole floor: below bodies, it is that of the nearest texel beside them.

    Args:
        light: Light on a floor that is black below bodies, so that texels at their feet are darker.
        free: Share (N, N, 1) of each texel that is not below a body.
    """
    known = free[..., 0] > _MIN_FREE
    if not known.any():
        return light
    beside = light / np.maximum(free, _MIN_FREE)
    if known.all():
        return beside
    # The nearest one, so that the floor beside a thin wall is not lit by what is behind the wall.
    holes = (~known).astype(np.uint8)
    _, labels = cv2.distanceTransformWithLabels(holes, cv2.DIST_L2, cv2.DIST_MASK_5, labelType=cv2.DIST_LABEL_PIXEL)
    nearest = np.asarray(labels, np.int64)
    by_label = np.zeros((int(nearest.max()) + 1, light.shape[-1]), np.float32)
    by_label[nearest[known]] = beside[known]
    return by_label[nearest]

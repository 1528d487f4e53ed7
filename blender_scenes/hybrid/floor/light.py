"""Light on the floor out of samples with noise, beside the bodies that stand on it."""

import cv2
import numpy as np

from blender_scenes.hybrid.denoiser import Denoiser
from blender_scenes.render.lost_light import lost_light_factor
from symolo.core.arrays import FloatImage

_MIN_FREE = np.float32(0.5)
"""Share of a texel beside a body below which the light there is taken from a neighbour."""
_GUIDE_ALBEDO = np.float32(0.5)
"""Albedo of the floor as a guide of the denoiser."""
_UP = np.array((0.0, 0.0, 1.0), np.float32)


def without_noise(light: FloatImage, free: FloatImage, denoised: Denoiser, *, keeps_mean: bool = False) -> FloatImage:
    """Return light (N, N, 3) on the whole floor, without noise.

    Args:
        light: Light on a floor that is black below bodies.
        free: Share (N, N, 1) of each texel that is not below a body.
        denoised: Denoiser. It gets the floor below bodies as a mirror image of the floor beside them, with its noise.
            If that floor were black, the denoised light at their feet would be too dark.
        keeps_mean: Whether the light that is not below bodies gets its mean back, of which the denoiser takes a part
            for noise. The ratio of two lights does not need it, because both lose about the same part.
    """
    known = free[..., 0] > _MIN_FREE
    if not known.any():
        return light
    nearest = nearest_free(free)
    whole = _mirrored(without_holes(light, free, nearest), known, nearest)
    even = denoised(whole, np.broadcast_to(_UP, light.shape), np.broadcast_to(_GUIDE_ALBEDO, light.shape))
    if keeps_mean:
        even *= np.float32(lost_light_factor(whole[known], even[known]))
    return even[nearest]


def without_holes(light: FloatImage, free: FloatImage, nearest: tuple[np.ndarray, np.ndarray]) -> FloatImage:
    """Return light (N, N, K) on the whole floor: below bodies, it is that of the nearest texel beside them.

    Args:
        light: Light on a floor that is black below bodies, so that texels at their feet are darker.
        free: Share (N, N, 1) of each texel that is not below a body.
        nearest: `nearest_free` of it.
    """
    return (light / np.maximum(free, _MIN_FREE))[nearest]


def _mirrored(light: FloatImage, known: np.ndarray, nearest: tuple[np.ndarray, np.ndarray]) -> FloatImage:
    """Return light (N, N, K) that is mirrored at the nearest known texel where it is not known, if it is known there.

    Copies of the nearest texel would be stripes of the same noise, which a denoiser does not take for noise.
    """
    rows, columns = (
        np.clip(2 * at - place, 0, count - 1)
        for at, place, count in zip(nearest, np.indices(known.shape), known.shape, strict=True)
    )
    return np.where(known[rows, columns][..., None], light[rows, columns], light)


def nearest_free(free: FloatImage) -> tuple[np.ndarray, np.ndarray]:
    """Return row and column (N, N) of the nearest texel that is not below a body, itself if there is no other.

    Args:
        free: Share (N, N, 1) of each texel that is not below a body.
    """
    known = free[..., 0] > _MIN_FREE
    if known.all() or not known.any():
        rows, columns = np.indices(known.shape)
        return rows, columns
    # The nearest one, so that the floor beside a thin wall is not lit by what is behind the wall.
    holes = (~known).astype(np.uint8)
    _, nearest = cv2.distanceTransformWithLabels(holes, cv2.DIST_L2, cv2.DIST_MASK_5, labelType=cv2.DIST_LABEL_PIXEL)
    labels = nearest.astype(np.int64)
    rows, columns = (np.zeros(int(labels.max()) + 1, np.int64) for _ in range(2))
    rows[labels[known]], columns[labels[known]] = np.nonzero(known)
    return rows[labels], columns[labels]

"""Shadow that a body throws on the floor in the light of several points, as a map."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import cv2
import numpy as np

from blender_scenes.hybrid.shadows.casters import Caster
from blender_scenes.hybrid.shadows.small_lights import on_floor
from symolo.core.arrays import Array, FloatImage

_FINER = 4
"""Default number of pixels that are drawn along the side of a texel."""
_BITS = 8
"""Binary digits of a place between two drawn pixels."""
_MAX_TEXELS = 1024
"""Maximum number of texels along a side."""
_MAX_PX = 1e6
"""Largest distance of a corner that is drawn from the rectangle; a corner at 0.2 mm a pixel is 200 m away."""


@dataclass(frozen=True)
class ShadowMask:
    """Map of a rectangle of the floor, with the share of the light that reaches each texel."""

    low: Array
    """(2,), lower left corner [m]."""
    texel_m: float
    """Size of a texel [m]."""
    share: FloatImage
    """(h, w) or (h, w, 3), share of the light that passes; rows along y."""

    def at(self, points: FloatImage) -> FloatImage:
        """Return the interpolated share, as it is stored, at points (H, W, 2) [m]; 1 beside the map and at NaN."""
        where = (points - self.low.astype(np.float32)) / np.float32(self.texel_m) - np.float32(0.5)
        u, v = (np.ascontiguousarray(np.nan_to_num(where[..., axis], nan=-9.0)) for axis in (0, 1))
        share = cv2.remap(self.share, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=(1.0,) * 3)
        return share.astype(np.float32, copy=False)


def shadow_mask(
    shapes: Sequence[Caster], light_points: Array, low: Array, high: Array, texel_m: float, *, finer: int = _FINER
) -> ShadowMask:
    """Return the shadow of bodies in a rectangle of the floor.

    Args:
        shapes: Bodies and faces.
        light_points: Points (K, 4) all over the light, as `small_lights` has them, each with an equal part of it. All
            places are above the shapes.
        low: Lower left corner (2,) of the rectangle.
        high: Its upper right corner (2,).
        texel_m: Size of a texel; it is larger for a large rectangle.
        finer: Number of pixels that are drawn along the side of a texel.
    """
    texel_m = max(texel_m, float(np.max(high - low)) / _MAX_TEXELS)
    width, height = np.ceil((high - low) / texel_m).astype(int).tolist()
    corners = np.concatenate([shape.corners for shape in shapes])
    ends = np.cumsum([0, *(len(shape.corners) for shape in shapes)]).tolist()
    shaded = np.zeros((height, width), np.float32)
    for point in light_points:
        # Whole numbers are the middles of drawn pixels.
        at = np.clip((on_floor(corners, point) - low) / texel_m * finer - 0.5, -_MAX_PX, _MAX_PX)
        drawn = np.zeros((height * finer, width * finer), np.uint8)
        places = np.rint(at * 2**_BITS).astype(np.int32)
        for shape, (begin, end) in zip(shapes, pairwise(ends), strict=True):
            outline = cv2.convexHull(places[begin:end]) if shape.is_body else places[begin:end]
            cv2.fillPoly(drawn, [outline], (255,), shift=_BITS)
        shaded += cv2.resize(drawn, (width, height), interpolation=cv2.INTER_AREA)
    return ShadowMask(low, texel_m, (1 - shaded / np.float32(255 * len(light_points))).astype(np.float32))

"""Shadow that a body throws on the floor in the light of several points, as a map."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from blender_scenes.hybrid.small_lights import on_floor
from symolo.core.arrays import Array, FloatImage

_FINER = 4
"""Number of pixels that are drawn along the side of a texel."""
_BITS = 8
"""Binary digits of a place between two drawn pixels."""
_MAX_TEXELS = 1024
"""Maximum number of texels along a side."""
_MAX_PX = 1e6
"""Largest distance of a corner that is drawn from the rectangle; a corner at 0.2 mm a pixel is 200 m away."""


@dataclass(frozen=True)
class ShadowMask:
    low: Array
    """(2,), lower left corner [m]."""
    texel_m: float
    share: FloatImage
    """(h, w), share of the light that passes; rows along y."""

    def at(self, points: FloatImage) -> FloatImage:
        """Return the interpolated share (H, W) at points (H, W, 2) [m]; 1 beside the map and where a point is NaN."""
        where = (points - self.low.astype(np.float32)) / np.float32(self.texel_m) - np.float32(0.5)
        u, v = (np.ascontiguousarray(np.nan_to_num(where[..., axis], nan=-9.0)) for axis in (0, 1))
        share = cv2.remap(self.share, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=(1.0,))
        return share.astype(np.float32, copy=False)


def shadow_mask(faces: Sequence[Array], light_points: Array, low: Array, high: Array, texel_m: float) -> ShadowMask:
    """Return the shadow of faces in a rectangle of the floor.

    Args:
        faces: Corners (K, 3) of each face.
        light_points: Points (K, 4) all over the light, as `small_lights` has them, each with an equal part of it. All
            places are above the faces.
        low: Lower left corner (2,) of the rectangle.
        high: Its upper right corner (2,).
        texel_m: Size of a texel; it is larger for a large rectangle.
    """
    texel_m = max(texel_m, float(np.max(high - low)) / _MAX_TEXELS)
    width, height = np.ceil((high - low) / texel_m).astype(int).tolist()
    corners, ends = np.concatenate(faces), np.cumsum([len(face) for face in faces])[:-1]
    shaded = np.zeros((height, width), np.float32)
    for point in light_points:
        # Whole numbers are the middles of drawn pixels.
        at = np.clip((on_floor(corners, point) - low) / texel_m * _FINER - 0.5, -_MAX_PX, _MAX_PX)
        drawn = np.zeros((height * _FINER, width * _FINER), np.uint8)
        for polygon in np.split(np.rint(at * 2**_BITS).astype(np.int32), ends):
            cv2.fillPoly(drawn, [polygon], (255,), shift=_BITS)
        shaded += cv2.resize(drawn, (width, height), interpolation=cv2.INTER_AREA)
    return ShadowMask(low, texel_m, (1 - shaded / np.float32(255 * len(light_points))).astype(np.float32))

"""Shadow that a body throws on the floor in the light of several points, as a map."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from blender_scenes.hybrid.shadows.casters import Caster
from blender_scenes.hybrid.shadows.small_lights import on_floor
from symolo.core.arrays import Array, FloatImage

_FINER = 4
"""Default number of pixels that are drawn along the side of a texel."""
_BITS = 8
"""Binary digits of a place between two drawn pixels."""
_MAX_TEXELS = 1024
"""Maximum number of texels along a side."""
_AT_ONCE = 4
"""Number of channels that OpenCV interpolates at once."""
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
        return _looked_up(self.share, *self.places(points))

    def places(self, points: FloatImage) -> tuple[FloatImage, FloatImage]:
        """Return column and row (H, W) of the map at points (H, W, 2) [m], in texels; beside the map at NaN."""
        where = (points - self.low.astype(np.float32)) / np.float32(self.texel_m) - np.float32(0.5)
        u, v = (np.ascontiguousarray(np.nan_to_num(where[..., axis], nan=-9.0)) for axis in (0, 1))
        return u, v


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
    shaded = sum(_drawn(shapes, light_points, low, high, texel_m, finer=finer), np.zeros((1, 1), np.float32))
    return ShadowMask(low, texel_m, (1 - shaded / np.float32(255 * len(light_points))).astype(np.float32))


def point_masks(
    shapes: Sequence[Caster], light_points: Array, low: Array, high: Array, texel_m: float, *, finer: int = _FINER
) -> list[ShadowMask]:
    """Return the shadow in each point of the light alone, four of them (h, w, 4) in a mask, the last ones with light.

    The arguments are those of `shadow_mask`.
    """
    texel_m = max(texel_m, float(np.max(high - low)) / _MAX_TEXELS)
    drawn = [*_drawn(shapes, light_points, low, high, texel_m, finer=finer)]
    drawn += [np.zeros_like(drawn[0])] * (-len(drawn) % _AT_ONCE)
    fours = (np.stack(drawn[i : i + _AT_ONCE], axis=-1) for i in range(0, len(drawn), _AT_ONCE))
    return [ShadowMask(low, texel_m, 1 - four / np.float32(255)) for four in fours]


def share_past_all(
    count: int,
    masks: Sequence[Sequence[ShadowMask]],
    grounds: Sequence[FloatImage],
    strengths: Sequence[FloatImage] | None = None,
) -> FloatImage:
    """Return the share (H, W) of a light that several bodies let through together.

    From one point of a light, a place of the floor has light only if no body hides the point. The product of the
    shares of all points would be right only if what the bodies hide were independent of each other.

    Args:
        count: Number of points of the light.
        masks: `point_masks` of each body, for the same points.
        grounds: The places (H, W, 2) in the frame of each body.
        strengths: How much (H, W) of the shadow of each body counts; None for all.
    """
    places = [of_body[0].places(ground) for of_body, ground in zip(masks, grounds, strict=True)]
    total: FloatImage = np.zeros((*grounds[0].shape[:-1], _AT_ONCE), np.float32)
    for of_points in zip(*masks, strict=True):
        through: FloatImage = np.ones_like(total)
        for number, (mask, at) in enumerate(zip(of_points, places, strict=True)):
            share = _looked_up(mask.share, *at)
            through = np.minimum(
                through, share if strengths is None else 1 - strengths[number][..., None] * (1 - share)
            )
        total += through
    # The points that fill up the last mask are hidden by none.
    return (total.sum(axis=-1) - (-count % _AT_ONCE)) / np.float32(count)


def _looked_up(share: FloatImage, u: FloatImage, v: FloatImage) -> FloatImage:
    values = cv2.remap(share, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=(1.0,) * 4)
    return values.astype(np.float32, copy=False)


def enclosing(where: np.ndarray) -> tuple[slice, slice]:
    """Return the rows and columns between the first and the last True of an image (H, W) that has one."""
    rows, columns = (slice(int(at.min()), int(at.max()) + 1) for at in np.nonzero(where))
    return rows, columns


def _drawn(
    shapes: Sequence[Caster], light_points: Array, low: Array, high: Array, texel_m: float, *, finer: int
) -> Iterator[NDArray[np.uint8]]:
    """Yield the shadow (h, w) in each point of the light, 255 where nothing passes."""
    width, height = np.ceil((high - low) / texel_m).astype(int).tolist()
    corners = np.concatenate([shape.corners for shape in shapes])
    ends = np.cumsum([0, *(len(shape.corners) for shape in shapes)]).tolist()
    for point in light_points:
        # Whole numbers are the middles of drawn pixels.
        at = np.clip((on_floor(corners, point) - low) / texel_m * finer - 0.5, -_MAX_PX, _MAX_PX)
        drawn = np.zeros((height * finer, width * finer), np.uint8)
        places = np.rint(at * 2**_BITS).astype(np.int32)
        for shape, (begin, end) in zip(shapes, pairwise(ends), strict=True):
            outline = cv2.convexHull(places[begin:end]) if shape.is_body else places[begin:end]
            cv2.fillPoly(drawn, [outline], (255,), shift=_BITS)
        yield cv2.resize(drawn, (width, height), interpolation=cv2.INTER_AREA).astype(np.uint8, copy=False)

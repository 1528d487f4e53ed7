"""The image behind a lens, warped from a pinhole image.

Cycles has no lens of this model. It renders a pinhole image of the same focal length with a margin, and each pixel of
the final image takes its light from the place where its undistorted ray meets the pinhole image.
"""

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np

from symolo.core.arrays import FloatImage
from symolo.core.geometry.lens import NO_DISTORTION, border_rays, refined
from symolo.core.geometry.pinhole import Intrinsics, rays_of

LIGHT_WIDTH_PX = 80
"""Minimum width of the light image of hybrid rendering. The width of the final image is halved as often as this
minimum allows."""

_SPARE_PX = 2
"""Margin beyond the outermost ray, for the interpolation."""
_COARSE, _NEWTON_STEPS = 33, 4


@dataclass(frozen=True)
class PinholeImage:
    """The rendered image. Without distortion, its pixel (u + left, v + top) is pixel (u, v) of the final image."""

    camera: Intrinsics
    left_px: int
    top_px: int


def pinhole_image(camera: Intrinsics) -> PinholeImage:
    """Return the pinhole image that contains every ray of the camera; without distortion it is the camera's image.

    Raises:
        ValueError: The lens model has no ray for some pixel of the border.
    """
    if camera.distortion == NO_DISTORTION:
        return PinholeImage(camera, 0, 0)
    focal, axis = np.array([camera.fx_px, camera.fy_px]), np.array([camera.cx_px, camera.cy_px])
    last = np.array([camera.width_px, camera.height_px]) - 1
    low, high = ((corner - axis) / focal for corner in (np.zeros(2), last))
    rays = border_rays(camera.distortion, (low[0], low[1]), (high[0], high[1]))
    if np.isnan(rays).any():
        raise ValueError(f"lens distortion {camera.distortion}: some pixels at the border of the image have no ray")
    reached = rays * focal + axis
    left, top = np.maximum(0, np.ceil(-reached.min(axis=0)) + _SPARE_PX).astype(int).tolist()
    right, bottom = np.maximum(0, np.ceil(reached.max(axis=0) - last) + _SPARE_PX).astype(int).tolist()
    width_px, height_px = camera.width_px + left + right, camera.height_px + top + bottom
    # In hybrid rendering, all pixels of a square with this side share one pixel of light.
    side_px = 2 ** int(np.log2(max(width_px / LIGHT_WIDTH_PX, 1)))
    pinhole = Intrinsics(
        -(-width_px // side_px) * side_px,
        -(-height_px // side_px) * side_px,
        camera.fx_px,
        camera.fy_px,
        camera.cx_px + left,
        camera.cy_px + top,
    )
    return PinholeImage(pinhole, left, top)


def through_lens(light: FloatImage, camera: Intrinsics, late: FloatImage | None = None) -> FloatImage:
    """Return the light (H, W, 3) of the final image.

    Args:
        light: Light of the pinhole image.
        camera: Camera of the final image.
        late: (H, W, 2), shift of each pixel's source to the right and down [px], by `rolling_shutter.lateness`; None
            for no shift.
    """
    if camera.distortion == NO_DISTORTION:
        return light
    at = sources(camera) if late is None else sources(camera) + late
    # A shifted source may be outside the margin; it then gets the light of the border.
    warped = cv2.remap(light, at[..., 0], at[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return warped.astype(np.float32, copy=False)


@lru_cache(maxsize=1)
def sources(camera: Intrinsics) -> FloatImage:
    """Return the place (H, W, 2) of each pixel's ray in the pinhole image, u and v.

    Only the rays of a coarse grid are computed from scratch, which takes a hundredth of the time. Values between them
    are interpolated and then refined by Newton's method.
    """
    last = np.array([camera.width_px, camera.height_px]) - 1
    coarse = np.indices((_COARSE, _COARSE))[::-1].reshape(2, -1).T / (_COARSE - 1)
    rays = rays_of(camera, coarse * last).astype(np.float32).reshape(_COARSE, _COARSE, 2)
    v, u = np.indices((camera.height_px, camera.width_px), dtype=np.float64)
    pixels = np.stack([u.ravel(), v.ravel()], axis=1)
    at = (pixels / last * (_COARSE - 1)).astype(np.float32).reshape(*u.shape, 2)
    near = cv2.remap(rays, at[..., 0], at[..., 1], cv2.INTER_LINEAR).reshape(-1, 2).astype(np.float64)
    focal, axis = np.array([camera.fx_px, camera.fy_px]), np.array([camera.cx_px, camera.cy_px])
    exact = refined(camera.distortion, (pixels - axis) / focal, near, _NEWTON_STEPS)
    pinhole = pinhole_image(camera)
    return (exact * focal + axis + (pinhole.left_px, pinhole.top_px)).astype(np.float32).reshape(*u.shape, 2)

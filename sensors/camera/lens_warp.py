"""The picture behind a lens, warped from a pinhole picture that is large enough.

Cycles has no lens of this model. It renders the pinhole picture, of the same focal length and with a margin, and each
pixel of the final picture takes its light from where its undistorted ray meets that.
"""

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from symolo.core.lens import NO_DISTORTION, border_rays, refined
from symolo.core.pinhole import Intrinsics, rays_of

Image = NDArray[np.float32]

LIGHT_WIDTH_PX = 80
"""Minimum width of the light image of hybrid rendering, which is the final one halved as often as this allows."""

_SPARE_PX = 2
"""Beyond the outermost ray, for the interpolation."""
_COARSE, _NEWTON_STEPS = 33, 4


@dataclass(frozen=True)
class PinholeImage:
    """What is rendered: pixel (u, v) of the final picture lies at (u + left, v + top), were there no distortion."""

    camera: Intrinsics
    left_px: int
    top_px: int


def pinhole_image(camera: Intrinsics) -> PinholeImage:
    """The pinhole picture that holds every ray of the camera; the camera's own where there is no distortion.

    Raises:
        ValueError: The lens brings no ray to some pixel of the border.
    """
    if camera.distortion == NO_DISTORTION:
        return PinholeImage(camera, 0, 0)
    focal, axis = np.array([camera.fx_px, camera.fy_px]), np.array([camera.cx_px, camera.cy_px])
    last = np.array([camera.width_px, camera.height_px]) - 1
    low, high = ((corner - axis) / focal for corner in (np.zeros(2), last))
    rays = border_rays(camera.distortion, (low[0], low[1]), (high[0], high[1]))
    if np.isnan(rays).any():
        raise ValueError(f"lens distortion {camera.distortion} brings no ray to some of the picture's border")
    reached = rays * focal + axis
    left, top = np.maximum(0, np.ceil(-reached.min(axis=0)) + _SPARE_PX).astype(int).tolist()
    right, bottom = np.maximum(0, np.ceil(reached.max(axis=0) - last) + _SPARE_PX).astype(int).tolist()
    width_px, height_px = camera.width_px + left + right, camera.height_px + top + bottom
    # Hybrid rendering lets each square of so many pixels share one pixel of light.
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


def through_lens(light: Image, camera: Intrinsics, late: Image | None = None) -> Image:
    """(H, W, 3) light of the final picture from that of its pinhole picture.

    Args:
        light: Of the pinhole picture.
        camera: Of the final picture.
        late: (H, W, 2) how much further right and down each pixel's light lies [px]; None where it lies at its ray.
    """
    if camera.distortion == NO_DISTORTION:
        return light
    at = sources(camera) if late is None else sources(camera) + late
    # What is late may lie beyond the margin; the border is the nearest to it that there is.
    seen = cv2.remap(light, at[..., 0], at[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return seen.astype(np.float32, copy=False)


@lru_cache(maxsize=1)
def sources(camera: Intrinsics) -> Image:
    """(H, W, 2) where in the pinhole picture the ray of each pixel is, u and v.

    Followed from the axis on a coarse grid alone, which costs a hundredth; between its points Newton has little to do.
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
    found = pinhole_image(camera)
    return (exact * focal + axis + (found.left_px, found.top_px)).astype(np.float32).reshape(*u.shape, 2)

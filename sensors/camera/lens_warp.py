"""The image behind a lens, warped from the image that Cycles renders.

Cycles has no lens of these models. It renders a pinhole image of the same focal length with a margin, and each pixel of
the final image takes its light from the place where its undistorted ray meets the pinhole image. For a fisheye lens, it
renders an image of an equidistant lens with its axis in the middle, from which the final image is taken likewise.
"""

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array, FloatImage
from symolo.core.geometry.fisheye import Fisheye
from symolo.core.geometry.lens import NO_DISTORTION, border_rays, refined
from symolo.core.geometry.pinhole import Intrinsics, directions_of, rays_of

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

    For a fisheye lens it is the image of an equidistant lens.

    Raises:
        ValueError: The lens model has no ray for some pixel of the border.
    """
    if camera.fisheye is not None:
        return _equidistant_image(camera, camera.fisheye)
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


def is_rendered_directly(camera: Intrinsics) -> bool:
    """Return whether the rendered image is the final image, so that nothing is warped."""
    return camera.distortion == NO_DISTORTION if camera.fisheye is None else pinhole_image(camera).camera == camera


def _equidistant_image(camera: Intrinsics, lens: Fisheye) -> PinholeImage:
    middle = 0.5 * (camera.width_px - 1), 0.5 * (camera.height_px - 1)
    if lens.is_equidistant and (camera.cx_px, camera.cy_px) == middle:
        return PinholeImage(camera, 0, 0)
    # The farthest pixel from the axis decides the size; beyond the field of view there is no light.
    corners = np.array([[u, v] for u in (0, camera.width_px - 1) for v in (0, camera.height_px - 1)], dtype=np.float64)
    beside = np.abs(corners - (camera.cx_px, camera.cy_px)).max(axis=0)
    stretch = _stretch(lens, np.linspace(0.0, lens.half_field_rad, 257)[1:]).max()
    reach = np.minimum(beside * stretch, camera.fx_px * lens.half_field_rad)
    left, top = (np.ceil(reach - (camera.cx_px, camera.cy_px)) + _SPARE_PX).astype(int).tolist()
    width_px, height_px = round(2 * (camera.cx_px + left)) + 1, round(2 * (camera.cy_px + top)) + 1
    axis = 0.5 * (width_px - 1), 0.5 * (height_px - 1)
    rendered = Intrinsics(width_px, height_px, camera.fx_px, camera.fy_px, *axis, fisheye=Fisheye(lens.half_field_rad))
    return PinholeImage(rendered, left, top)


def _stretch(lens: Fisheye, angle: Array) -> Array:
    """Return the distance of a ray from the axis behind an equidistant lens over that behind this lens."""
    return angle / lens.radius(angle)


def through_lens(light: FloatImage, camera: Intrinsics, shift_px: FloatImage | None = None) -> FloatImage:
    """Return the light (H, W, 3) of the final image.

    Args:
        light: Light of the pinhole image.
        camera: Camera of the final image.
        shift_px: (H, W, 2), shift of each pixel's source to the right and down, by `rolling_shutter_shift`; None for no
            shift.
    """
    if is_rendered_directly(camera):
        return light
    at = sources(camera) if shift_px is None else sources(camera) + shift_px
    dark = np.isnan(at[..., 0])
    # A shifted source may be outside the margin; it then gets the light of the border.
    at = np.nan_to_num(at)
    warped = cv2.remap(light, at[..., 0], at[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    warped[dark] = 0.0
    return warped.astype(np.float32, copy=False)


@lru_cache(maxsize=1)
def sources(camera: Intrinsics) -> FloatImage:
    """Return the place (H, W, 2) of each pixel's ray in the pinhole image, u and v.

    Only the rays of a coarse grid are computed from scratch, which takes a hundredth of the time. Values between them
    are interpolated and then refined by Newton's method. Pixels beyond the field of view of a fisheye lens have NaN.
    """
    if camera.fisheye is not None:
        return _fisheye_sources(camera, camera.fisheye)
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


def _fisheye_sources(camera: Intrinsics, lens: Fisheye) -> FloatImage:
    v, u = np.indices((camera.height_px, camera.width_px), dtype=np.float64)
    on_sensor = np.stack([(u - camera.cx_px) / camera.fx_px, (v - camera.cy_px) / camera.fy_px], axis=-1)
    radius = np.hypot(on_sensor[..., 0], on_sensor[..., 1])
    angle = lens.angle(radius)
    equidistant = on_sensor * np.where(radius > 0.0, angle / np.maximum(radius, 1e-12), 1.0)[..., None]
    rendered = pinhole_image(camera).camera
    places = equidistant * (rendered.fx_px, rendered.fy_px) + (rendered.cx_px, rendered.cy_px)
    return places.astype(np.float32)


def directions_in(camera: Intrinsics) -> Array:
    """Return the directions (H, W, 3) in C through the middles of the pixels.

    Their z is 1 for a pinhole camera. For a fisheye lens their length is 1, and NaN beyond its field of view.
    """
    at = np.stack(np.meshgrid(np.arange(camera.width_px), np.arange(camera.height_px)), axis=-1).astype(np.float64)
    if camera.fisheye is not None:
        return directions_of(camera, at.reshape(-1, 2)).reshape(*at.shape[:2], 3)
    pinhole = pinhole_image(camera).camera
    if camera.distortion != NO_DISTORTION:
        at = sources(camera).astype(np.float64)
    slopes = (at - (pinhole.cx_px, pinhole.cy_px)) / (pinhole.fx_px, pinhole.fy_px)
    return np.concatenate([slopes, np.ones((*slopes.shape[:2], 1))], axis=-1)


def field_of_view(camera: Intrinsics) -> NDArray[np.bool_] | None:
    """Return which pixels (H, W) the lens brings light to; None for all of them."""
    if camera.fisheye is None:
        return None
    return ~np.isnan(directions_in(camera)[..., 2])

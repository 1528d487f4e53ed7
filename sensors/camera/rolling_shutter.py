"""Correction of a rolling shutter behind a lens, in which the row of a pixel is not that of its pinhole ray.

Cycles exposes the pinhole image row by row. If the lens bends a ray to a different row, its light is therefore too
early or too late, and its source has moved over the pinhole image in the meantime. This is corrected to first order.
The correction holds for all points if the camera only turns; if it moves, it holds for points on the floor. A fisheye
lens, whose coefficients bend rays by a few rows at most, is not corrected.
"""

import numpy as np

from sensors.camera.lens_warp import pinhole_image, sources
from sensors.camera.shutter import window
from sensors.camera.views import FrameView
from symolo.core.arrays import FloatImage
from symolo.core.geometry.lens import NO_DISTORTION
from symolo.core.geometry.pinhole import Intrinsics, Shutter


def rolling_shutter_shift(view: FrameView, camera: Intrinsics, shutter: Shutter) -> FloatImage | None:
    """Return the shift (H, W, 2) [px] for `through_lens`; None if nothing needs correction."""
    # A camera with a fisheye lens has no `distortion`.
    if camera.distortion == NO_DISTORTION or shutter.read_out_s == 0 or not view.exposure:
        return None
    pinhole = pinhole_image(camera)
    at = sources(camera).astype(np.float64)
    rows_late = at[..., 1] - pinhole.top_px - np.arange(camera.height_px)[:, None]
    late_s = rows_late * (shutter.read_out_s / camera.height_px)
    axis, focal = (pinhole.camera.cx_px, pinhole.camera.cy_px), (pinhole.camera.fx_px, pinhole.camera.fy_px)
    flow = _flow((at - axis) / focal, *_twist(view, window(shutter, camera).length_s), np.array(view.X_WC))
    return (late_s[..., None] * flow * focal).astype(np.float32)


def _twist(view: FrameView, length_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean velocity (3,) and turn rate (3,) of C during the exposure, in the axes of C at its middle."""
    opened, closed = view.exposure[0], view.exposure[-1]
    X_0, X_1, X = np.array(opened.X_WC), np.array(closed.X_WC), np.array(view.X_WC)
    turned = np.array([0.0, 0.0, closed.robot_pose[2] - opened.robot_pose[2]])
    return X[:3, :3].T @ (X_1 - X_0)[:3, 3] / length_s, X[:3, :3].T @ turned / length_s


def _flow(rays: np.ndarray, velocity: np.ndarray, rate: np.ndarray, X_WC: np.ndarray) -> np.ndarray:
    """Return the image velocity (H, W, 2) of floor points on rays (H, W, 2), or of infinity above the horizon.

    Longuet-Higgins and Prazdny, The interpretation of a moving retinal image (1980), Eq. 2.
    """
    x, y = rays[..., 0], rays[..., 1]
    down = -(X_WC[2, 0] * x + X_WC[2, 1] * y + X_WC[2, 2])
    nearness = np.maximum(down, 0.0) / X_WC[2, 3]
    (u, v, w), (a, b, c) = velocity, rate
    across = nearness * (x * w - u) + a * x * y - b * (1 + x * x) + c * y
    along = nearness * (y * w - v) + a * (1 + y * y) - b * x * y - c * x
    return np.stack([across, along], axis=-1)

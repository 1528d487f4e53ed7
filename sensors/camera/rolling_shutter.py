"""What a rolling shutter does behind a lens: a pixel's row is not that of its ray in the pinhole picture.

Cycles exposes the pinhole picture row by row, so that the light of a ray that the lens bends to another row is there
too early or too late by their distance. What the pixel should see has moved over the pinhole picture since. It is made
up for to first order: exactly where the camera turns, and for points on the floor where it moves.
"""

import numpy as np

from sensors.camera.lens_warp import Image, pinhole_image, sources
from sensors.camera.shutter import window
from sensors.camera.views import FrameView
from symolo.core.lens import NO_DISTORTION
from symolo.core.pinhole import Intrinsics, Shutter


def lateness(view: FrameView, camera: Intrinsics, shutter: Shutter) -> Image | None:
    """(H, W, 2) for `through_lens`; None where there is nothing to make up for."""
    if camera.distortion == NO_DISTORTION or shutter.read_out_s == 0 or not view.exposure:
        return None
    found = pinhole_image(camera)
    at = sources(camera).astype(np.float64)
    rows_late = at[..., 1] - found.top_px - np.arange(camera.height_px)[:, None]
    late_s = rows_late * (shutter.read_out_s / camera.height_px)
    axis, focal = (found.camera.cx_px, found.camera.cy_px), (found.camera.fx_px, found.camera.fy_px)
    flow = _flow((at - axis) / focal, *_twist(view, window(shutter, camera).length_s), np.array(view.X_WC))
    return (late_s[..., None] * flow * focal).astype(np.float32)


def _twist(view: FrameView, length_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Mean velocity (3,) and turn rate (3,) of C during the exposure, along its own axes in the middle."""
    opened, closed = view.exposure[0], view.exposure[-1]
    X_0, X_1, X = np.array(opened.X_WC), np.array(closed.X_WC), np.array(view.X_WC)
    turned = np.array([0.0, 0.0, closed.robot_pose[2] - opened.robot_pose[2]])
    return X[:3, :3].T @ (X_1 - X_0)[:3, 3] / length_s, X[:3, :3].T @ turned / length_s


def _flow(rays: np.ndarray, velocity: np.ndarray, rate: np.ndarray, X_WC: np.ndarray) -> np.ndarray:
    """(H, W, 2) how fast what lies on rays (H, W, 2) moves over them; above the horizon it is taken for far away.

    Longuet-Higgins and Prazdny, The interpretation of a moving retinal image (1980), Eq. 2.
    """
    x, y = rays[..., 0], rays[..., 1]
    down = -(X_WC[2, 0] * x + X_WC[2, 1] * y + X_WC[2, 2])
    nearness = np.maximum(down, 0.0) / X_WC[2, 3]
    (u, v, w), (a, b, c) = velocity, rate
    across = nearness * (x * w - u) + a * x * y - b * (1 + x * x) + c * y
    along = nearness * (y * w - v) + a * (1 + y * y) - b * x * y - c * x
    return np.stack([across, along], axis=-1)

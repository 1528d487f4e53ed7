"""Optical flow to the next image."""

import numpy as np

from blender_scenes.annotations.png import PngImage
from blender_scenes.annotations.seen import VisibleScene
from sensors.camera.views import FrameView
from symolo.core.arrays import Array
from symolo.core.pinhole import project
from symolo.dataset.annotations import FLOW_PER_PX, FLOW_ZERO

_NEAREST_M = 1e-3


def flow(seen: VisibleScene) -> PngImage | None:
    """(H, W, 3), 2^15 + 64 du, 2^15 + 64 dv and 1 where valid, all 0 elsewhere; None after the last image.

    From the pixel's middle to where the point met there is at the next shutter, moving obstacles included, seen or not.
    The sky turns with the camera as something infinitely far. Invalid: behind the next camera, or 512 px off.
    """
    if seen.following is None:
        return None
    X_WC = np.array(seen.following.X_WC)
    points = _moved(seen, seen.following)
    height, width = seen.instance.shape
    pixels, depth = project(seen.job.camera, X_WC, _sky_moved(seen, points, X_WC).reshape(-1, 3))
    u, v = np.meshgrid(np.arange(width), np.arange(height))
    change = pixels.reshape(height, width, 2) - np.stack([u, v], axis=-1)
    coded = FLOW_ZERO + np.rint(FLOW_PER_PX * np.nan_to_num(change, nan=np.inf))
    valid = np.all((coded >= 0) & (coded < 2 * FLOW_ZERO), axis=-1) & (depth.reshape(height, width) > _NEAREST_M)
    return np.where(valid[..., None], np.concatenate([coded, valid[..., None]], axis=-1), 0).astype(np.uint16)


def _moved(seen: VisibleScene, following: FrameView) -> Array:
    """(H, W, 3), where the points of each pixel are at the next shutter, in W."""
    points = seen.point_W.copy()
    for one in seen.job.instances.known:
        if one.moves:
            X_WW = one.pose_X_WI(following) @ np.linalg.inv(one.pose_X_WI(seen.view))
            mask = seen.instance == one.id
            points[mask] = points[mask] @ X_WW[:3, :3].T + X_WW[:3, 3]
    return points


def _sky_moved(seen: VisibleScene, points: Array, X_WC: Array) -> Array:
    """The points, with those of the sky as far from the next camera as from this one, in the same direction."""
    return np.where(seen.instance[..., None] == 0, X_WC[:3, 3] + seen.rays_W, points)

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
    """Return (H, W, 3): 2^15 + 64 du, 2^15 + 64 dv and 1 where valid, 0 elsewhere; None after the last image.

    The flow leads from the pixel's middle to the place of the same point in the next image, visible or not; moving
    obstacles are taken into account. The sky is infinitely far. Invalid: behind the next camera, or 512 px away.
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
    """Return the points (H, W, 3) of the pixels, in W, at the time of the next image."""
    points = seen.point_W.copy()
    for one in seen.job.instances.known:
        if one.moves:
            X_WW = one.pose_X_WI(following) @ np.linalg.inv(one.pose_X_WI(seen.view))
            mask = seen.instance == one.id
            points[mask] = points[mask] @ X_WW[:3, :3].T + X_WW[:3, 3]
    return points


def _sky_moved(seen: VisibleScene, points: Array, X_WC: Array) -> Array:
    """Return the points, with those of the sky at the same distance and direction from the next camera."""
    return np.where(seen.instance[..., None] == 0, X_WC[:3, 3] + seen.rays_W, points)

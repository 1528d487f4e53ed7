"""The silhouette of a box: where it would be visible if nothing were in front of it."""

import numpy as np
from numpy.typing import NDArray

from blender_scenes.annotations.job import Solid
from blender_scenes.annotations.seen import VisibleScene
from symolo.core.lens import NO_DISTORTION
from symolo.core.pinhole import project


def silhouette(seen: VisibleScene, solid: Solid) -> NDArray[np.bool_]:
    """Return (H, W) whether the ray through each pixel's middle meets the box, in closed form, by its three slabs.

    Pixels in which the box is visible count in any case: the renderer's rays are up to 0.005 px from the middle.
    """
    mask = seen.instance == solid.instance_id
    rows, columns = _window(seen, solid)
    X_WO = solid.pose_X_WO(seen.pose_X_WI(solid.instance_id))
    rays = seen.rays_W[rows, columns] @ X_WO[:3, :3]
    eye = (seen.X_WC[:3, 3] - X_WO[:3, 3]) @ X_WO[:3, :3]
    half = 0.5 * np.array(solid.size_m)
    with np.errstate(divide="ignore", invalid="ignore"):  # infinity is right for a ray parallel to a slab
        one, other = (-half - eye) / rays, (half - eye) / rays
    enters, leaves = np.fmin(one, other).max(axis=-1), np.fmax(one, other).min(axis=-1)
    mask[rows, columns] |= (leaves >= enters) & (leaves > 0)
    return mask


def _window(seen: VisibleScene, solid: Solid) -> tuple[slice, slice]:
    """Return rows and columns outside of which the box cannot be; all if a part of it is behind the camera."""
    pixels, depth = project(seen.job.camera, seen.X_WC, solid.corners(seen.pose_X_WI(solid.instance_id)))
    height, width = seen.instance.shape
    if np.any(depth <= 0) or seen.job.camera.distortion != NO_DISTORTION:  # a distorted edge reaches beyond its ends
        return (slice(0), slice(0)) if np.all(depth <= 0) else (slice(height), slice(width))
    low = np.clip(np.floor(pixels.min(axis=0)), 0, (width, height)).astype(int)
    high = np.clip(np.ceil(pixels.max(axis=0)) + 1, 0, (width, height)).astype(int)
    return slice(low[1], high[1]), slice(low[0], high[0])


def reaches_beyond(seen: VisibleScene, solid: Solid) -> bool:
    """Return whether a part of the box is outside the image or behind the camera."""
    pixels, depth = project(seen.job.camera, seen.X_WC, solid.corners(seen.pose_X_WI(solid.instance_id)))
    height, width = seen.instance.shape
    within = (pixels >= -0.5) & (pixels <= (width - 0.5, height - 0.5))  # False where the lens has no pixel
    return bool(np.any(depth <= 0) or not np.all(within))

"""Annotations that are images, as functions of a `VisibleScene`, with the table of their names and their PNG files."""

from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray

from blender_scenes.annotations.instances import ON_THE_FLOOR
from blender_scenes.annotations.visible_scene import VisibleScene
from sensors.camera.views import FrameView
from symolo.core.arrays import Array
from symolo.core.geometry.pinhole import project
from symolo.dataset.annotations import (
    CATEGORIES,
    DEPTH_RANGE_M,
    DEPTH_UNIT_M,
    FLOW_PER_PX,
    FLOW_ZERO,
    NORMAL_SCALE,
    NORMAL_ZERO,
    AnnotationName,
)

PngImage = NDArray[np.uint8] | NDArray[np.uint16]
"""(H, W), or (H, W, 3) with the channels red, green, blue."""

_COMPRESSION = 4
"""Level of zlib; higher ones take much more time for little less size."""
_MIN_DEPTH_M = 1e-3
"""Depth in the next image below which there is no flow."""


def instance(seen: VisibleScene) -> PngImage:
    """Return the ids (H, W) of the instances; 0 where there is no surface."""
    return seen.instance.astype(np.uint16)


def semantic(seen: VisibleScene) -> PngImage:
    """Return the ids (H, W) of the categories."""
    return seen.category.astype(np.uint8)


def free_floor(seen: VisibleScene) -> PngImage:
    """Return (H, W): 255 where floor or line is visible, 0 elsewhere."""
    free = [CATEGORIES.index(category) for category in CATEGORIES if category in ON_THE_FLOOR]
    return np.where(np.isin(seen.category, free), 255, 0).astype(np.uint8)


def depth(seen: VisibleScene) -> PngImage:
    """Return the depth (H, W) along the optical axis in units of 0.1 mm; 0 where there is no surface within 6.5 m.

    For a fisheye lens it is the distance from the lens.
    """
    within = seen.depth_m <= DEPTH_RANGE_M
    return np.where(within, np.rint(seen.depth_m / DEPTH_UNIT_M), 0).astype(np.uint16)


def normals(seen: VisibleScene) -> PngImage:
    """Return (H, W, 3): x, y, z in C as 32768 + 32767 n, towards the camera; 0 where there is no surface."""
    normal_C = seen.passes.normal_W @ seen.X_WC[:3, :3]
    has_surface = seen.passes.mesh[..., None] > 0
    return np.where(has_surface, NORMAL_ZERO + np.rint(NORMAL_SCALE * normal_C), 0).astype(np.uint16)


def flow(seen: VisibleScene) -> PngImage | None:
    """Return (H, W, 3): 2^15 + 64 du, 2^15 + 64 dv and 1 where valid, 0 elsewhere; None after the last image.

    The flow leads from the pixel's middle to the place of the same point in the next image, visible or not; moving
    obstacles are taken into account. The sky is infinitely far. Invalid: behind the next camera, or 512 px away.
    """
    if seen.following is None:
        return None
    X_WC = np.array(seen.following.X_WC)
    # The sky is infinitely far: its points stay at the same distance and direction from the next camera.
    is_sky = seen.instance[..., None] == 0
    points = np.where(is_sky, X_WC[:3, 3] + seen.rays_W, _points_at(seen.following, seen))
    height, width = seen.instance.shape
    pixels, depth_m = project(seen.job.camera, X_WC, points.reshape(-1, 3))
    u, v = np.meshgrid(np.arange(width), np.arange(height))
    change = pixels.reshape(height, width, 2) - np.stack([u, v], axis=-1)
    coded = FLOW_ZERO + np.rint(FLOW_PER_PX * np.nan_to_num(change, nan=np.inf))
    valid = np.all((coded >= 0) & (coded < 2 * FLOW_ZERO), axis=-1) & (depth_m.reshape(height, width) > _MIN_DEPTH_M)
    return np.where(valid[..., None], np.concatenate([coded, valid[..., None]], axis=-1), 0).astype(np.uint16)


def _points_at(following: FrameView, seen: VisibleScene) -> Array:
    """Return the points (H, W, 3) of the pixels, in W, at the time of the next image."""
    points = seen.point_W.copy()
    for one in seen.job.instances.known:
        if one.moves:
            X_WW = one.pose_X_WI(following) @ np.linalg.inv(one.pose_X_WI(seen.view))
            mask = seen.instance == one.id
            points[mask] = points[mask] @ X_WW[:3, :3].T + X_WW[:3, 3]
    return points


IMAGE_ANNOTATIONS: dict[AnnotationName, Callable[[VisibleScene], PngImage | None]] = {
    "depth": depth,
    "instance": instance,
    "semantic": semantic,
    "normals": normals,
    "flow": flow,
    "free_floor": free_floor,
}
"""Annotations with a PNG file for each image."""


def encode_png(image: PngImage) -> bytes:
    """Return a PNG file of 8 or 16 bits per channel, with the same bytes for the same pixels."""
    ordered = image if image.ndim == 2 else image[..., ::-1]  # OpenCV takes blue, green, red
    done, data = cv2.imencode(".png", np.ascontiguousarray(ordered), [cv2.IMWRITE_PNG_COMPRESSION, _COMPRESSION])
    if not done:
        raise OSError("OpenCV could not encode an annotation as PNG")
    return data.tobytes()

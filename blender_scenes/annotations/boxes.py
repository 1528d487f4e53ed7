"""Boxes of walls and obstacles: in the image around the visible part and around all of it, and in space."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blender_scenes.annotations.job import Solid
from blender_scenes.annotations.occlusion import triangles
from blender_scenes.annotations.visible_scene import VisibleScene
from physics.arena.triangle_rays import TriangleBody
from symolo.core.arrays import Array
from symolo.core.geometry.lens import NO_DISTORTION
from symolo.core.geometry.pinhole import project
from symolo.core.geometry.poses import Matrix4, as_rows
from symolo.dataset.annotations import Box3D, PixelBox, pixel_box

_FAR = 1000.0
"""Length of a ray along the optical axis [m]."""
_DECIMALS = 9
"""Digits of poses after the decimal point, down to a nanometre."""


@dataclass(frozen=True)
class Box2D:
    """An object that is visible in an image."""

    bbox: PixelBox
    """Box around the visible part."""
    area: int
    """Number of pixels in which it is visible."""
    amodal_bbox: PixelBox
    """Box around all of it that lies within the image, hidden or not."""
    amodal_area: int
    """Number of pixels in which it would be visible if nothing were in front of it."""
    visible_fraction: float
    """`area` divided by `amodal_area`."""
    truncated: bool
    """Whether it continues beyond the image's border."""


def box_2d(seen: VisibleScene, solid: Solid, whole: NDArray[np.bool_]) -> Box2D:
    """Return the boxes of a wall or obstacle whose silhouette `whole` (H, W) is not empty."""
    visible = seen.instance == solid.instance_id
    area, amodal_area = int(visible.sum()), int(whole.sum())
    return Box2D(
        bbox=pixel_box(visible),
        area=area,
        amodal_bbox=pixel_box(whole),
        amodal_area=amodal_area,
        visible_fraction=round(area / amodal_area, 6),
        truncated=reaches_beyond(seen, solid),
    )


def box_3d(seen: VisibleScene, solid: Solid) -> Box3D:
    """Return the size of a wall or obstacle, and its poses in W and in C."""
    X_WO = solid.pose_X_WO(seen.pose_X_WI(solid.instance_id))
    return Box3D(solid.size_m, _rows(X_WO), _rows(np.linalg.inv(seen.X_WC) @ X_WO))


def _rows(matrix: Array) -> Matrix4:
    return as_rows(np.round(matrix, _DECIMALS) + 0.0)  # no -0.0


def silhouette(seen: VisibleScene, solid: Solid) -> NDArray[np.bool_]:
    """Return (H, W) whether the ray through each pixel's middle meets the box, in closed form, by its three slabs.

    Of an obstacle of triangles, the ray must meet one of them too.
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
    # The ray is inside the box where it is inside all three slabs: after its last entry and before its first exit.
    enters, leaves = np.fmin(one, other).max(axis=-1), np.fmax(one, other).min(axis=-1)
    meets = (leaves >= enters) & (leaves > 0)
    body = _triangles_of(seen, solid)
    if body is not None and meets.any():
        along = _FAR * seen.rays_W[rows, columns][meets]
        meets[meets] = np.isfinite(body.cast(np.tile(seen.X_WC[:3, 3], (len(along), 1)), along)[0])
    mask[rows, columns] |= meets
    return mask


def _triangles_of(seen: VisibleScene, solid: Solid) -> TriangleBody | None:
    """Return the triangles of an obstacle in W, or None for a box, whose rendered mesh has faces of four corners."""
    scene = seen.job.scene
    number = seen.job.instances.of_mesh.index(solid.instance_id) - 1
    mesh = (*scene.meshes, *scene.robot_parts, *scene.moving)[number]
    if any(len(face) != 3 for face in mesh.faces):
        return None
    X_WI = seen.pose_X_WI(solid.instance_id)
    return TriangleBody.from_corners(triangles(mesh) @ X_WI[:3, :3].T + X_WI[:3, 3])


def _window(seen: VisibleScene, solid: Solid) -> tuple[slice, slice]:
    """Return rows and columns outside of which the box cannot be; all if a part of it is behind the camera."""
    pixels, depth = _corners(seen, solid)
    height, width = seen.instance.shape
    camera = seen.job.camera
    if camera.fisheye is not None:
        return slice(height), slice(width)
    if np.any(depth <= 0) or camera.distortion != NO_DISTORTION:  # a distorted edge reaches beyond its ends
        return (slice(0), slice(0)) if np.all(depth <= 0) else (slice(height), slice(width))
    low = np.clip(np.floor(pixels.min(axis=0)), 0, (width, height)).astype(int)
    high = np.clip(np.ceil(pixels.max(axis=0)) + 1, 0, (width, height)).astype(int)
    return slice(low[1], high[1]), slice(low[0], high[0])


def reaches_beyond(seen: VisibleScene, solid: Solid) -> bool:
    """Return whether a part of the box is outside the image or behind the camera."""
    pixels, depth = _corners(seen, solid)
    height, width = seen.instance.shape
    within = (pixels >= -0.5) & (pixels <= (width - 0.5, height - 0.5))  # False where the lens has no pixel
    return bool(np.any(depth <= 0) or not np.all(within))


def _corners(seen: VisibleScene, solid: Solid) -> tuple[Array, Array]:
    """Return the pixels (8, 2) and the depths (8,) of the box's corners."""
    return project(seen.job.camera, seen.X_WC, solid.corners(seen.pose_X_WI(solid.instance_id)))

"""The visible scene of a frame: mesh, point and normal in the middle of each pixel."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from blender_scenes.annotations.job import AnnotationJob
from sensors.camera.lens_warp import directions_in, is_rendered_directly, pinhole_image, sources
from sensors.camera.views import FrameView
from symolo.core.arrays import Array
from symolo.core.geometry.pinhole import Intrinsics

_STEEPEST = 1e-3
"""Cosine between ray and normal below which the equation of the plane is too ill-conditioned to correct a depth."""


@dataclass(frozen=True)
class Passes:
    """Blender's passes for each pixel, at a place up to 0.005 px from its middle."""

    mesh: NDArray[np.int64]
    """(H, W), number of the mesh, 0 where there is no surface."""
    point_W: Array
    """(H, W, 3), point on the surface in W [m]."""
    normal_W: Array
    """(H, W, 3), unit normal of the geometry in W, towards the camera."""

    def through_lens(self, camera: Intrinsics) -> "Passes":
        """Return the passes of the image behind a lens: each pixel takes the nearest pixel of the pinhole image."""
        if is_rendered_directly(camera):
            return self
        at, pinhole = sources(camera), pinhole_image(camera).camera
        # Beyond the field of view of a fisheye lens, the first pixel stands for darkness: it is in a corner.
        u, v = np.moveaxis(np.rint(np.nan_to_num(at)).astype(int), -1, 0)
        u, v = np.clip(u, 0, pinhole.width_px - 1), np.clip(v, 0, pinhole.height_px - 1)
        return Passes(self.mesh[v, u], self.point_W[v, u], self.normal_W[v, u])

    @classmethod
    def from_channels(cls, channels: Mapping[str, NDArray[np.generic]], layer: str) -> "Passes":
        """Return the passes from the channels of Blender's multilayer OpenEXR file."""

        def vector(name: str) -> Array:
            return np.stack([channels[f"{layer}.{name}.{axis}"] for axis in "XYZ"], axis=-1).astype(np.float64)

        mesh = np.rint(channels[f"{layer}.IndexOB.X"].astype(np.float64)).astype(np.int64)
        return cls(mesh, vector("Position"), vector("Normal"))


@dataclass(frozen=True)
class VisibleScene:
    """What each pixel of one image shows, computed from the passes of the renderer; all arrays are (H, W, ...)."""

    job: AnnotationJob
    view: FrameView
    following: FrameView | None
    """View of the next image; None for the last image."""
    passes: Passes

    @cached_property
    def X_WC(self) -> Array:
        return np.array(self.view.X_WC)

    def pose_X_WI(self, instance_id: int) -> Array:
        """Return the pose (4, 4) of the frame of an instance's geometry."""
        return self.job.instances.known[instance_id - 1].pose_X_WI(self.view)

    @cached_property
    def instance(self) -> NDArray[np.int64]:
        """(H, W), ids of the instances, 0 where there is no surface."""
        return np.array(self.job.instances.of_mesh)[self.passes.mesh]

    @cached_property
    def category(self) -> NDArray[np.int64]:
        """(H, W), ids of the categories."""
        return self.job.instances.category_ids[self.instance]

    @cached_property
    def rays_W(self) -> Array:
        """(H, W, 3), rays in W through the pixels' middles; their length along the optical axis is 1.

        For a fisheye lens their length is 1, and NaN beyond its field of view.
        """
        return directions_in(self.job.camera) @ self.X_WC[:3, :3].T

    @cached_property
    def depth_m(self) -> Array:
        """(H, W), depth along the optical axis, or distance from a fisheye lens; 0 where there is no surface.

        It is the depth where the ray through the exact middle of the pixel meets the plane of the surface: a thousandth
        of a pixel matters where a ray meets the floor at a few degrees.
        """
        to_point = self.passes.point_W - self.X_WC[:3, 3]
        direct = to_point @ self.X_WC[:3, 2]
        if self.job.camera.fisheye is not None:
            direct = np.linalg.norm(to_point, axis=-1)
        facing = np.einsum("hwk,hwk->hw", self.passes.normal_W, self.rays_W)
        height = np.einsum("hwk,hwk->hw", self.passes.normal_W, to_point)
        steep = np.abs(facing) < _STEEPEST
        depth = np.where(steep, direct, height / np.where(steep, 1.0, facing))
        return np.where(self.passes.mesh > 0, depth, 0.0)

    @cached_property
    def point_W(self) -> Array:
        """(H, W, 3), points of the surfaces in W in the pixels' middles; the camera's place where there is none."""
        return self.X_WC[:3, 3] + self.rays_W * self.depth_m[..., None]

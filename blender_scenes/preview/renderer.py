"""A job's images without Blender, in some hundredths of a second each."""

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from blender_scenes.preview.albedo import albedo
from blender_scenes.preview.light import from_all_around, from_panels, from_sky, from_sun
from blender_scenes.preview.rasteriser import Ints, VisibleTriangles, rasterise
from blender_scenes.preview.sun_shadow import SunShadow
from blender_scenes.preview.triangles import Triangles
from blender_scenes.render.job import RenderJob
from blender_scenes.render.user_image_reader import read_user_image
from blender_scenes.scene.typical import typical_color
from configs.assets.images import read_image
from sensors.camera.colour import as_measured
from sensors.camera.lens_warp import pinhole_image, through_lens
from sensors.camera.metering import median_luminance, metered_views, metering_camera
from sensors.camera.response import develop
from sensors.camera.views import FrameView
from symolo.core.arrays import Array, FloatImage
from symolo.core.geometry.pinhole import Intrinsics
from symolo.core.geometry.poses import pose_X_WR


class FlatRenderer:
    """A renderer of a job's images in flat colours.

    It leaves out textures other than the user's images, gloss, transparency, shadows other than those of the sun on
    things that stand still, and motion blur.

    Raises:
        ValueError: A face of the scene is not convex, no light reaches what the camera sees, or an image of the user
            is not in its folder.
    """

    def __init__(self, job: RenderJob, user_files: Path | None = None) -> None:
        """Prepare the scene of a job; `user_files` is the folder of the user's files by their SHA-256."""
        scene = job.scene
        numbers = {surface.name: number for number, surface in enumerate(scene.surfaces)}
        self._job = job
        self._pixels = cache(lambda sha256: read_image(read_user_image(user_files, sha256)))
        self._still = Triangles.from_meshes(scene.meshes, numbers)
        self._moving = tuple(Triangles.from_meshes((mesh,), numbers) for mesh in scene.moving)
        self._robot = Triangles.from_meshes(scene.robot_in_sight, numbers)
        colors = np.array([typical_color(surface) for surface in scene.surfaces])
        self._all_around = from_all_around(scene.panels, self._still, colors[self._still.surface])
        self._shadow = SunShadow.from_scene(scene.sun, self._still) if scene.sun else None
        self._pinhole = pinhole_image(job.camera).camera
        small = metering_camera(self._pinhole)
        metered = np.concatenate([self.light(view, small) for view in metered_views(job.frames)])
        self._metered = median_luminance(as_measured(metered, job.response.colour_filter))

    def image(self, view: FrameView) -> NDArray[np.uint8]:
        """Return the 8-bit RGB image (H, W, 3) of one of the job's frames, developed like Blender's images."""
        light = self.light(view, self._pinhole) * np.array(view.light_gain, np.float32)
        seen = through_lens(light, self._job.camera)
        return develop(seen, self._job.response, self._metered, view.number)

    def light(self, view: FrameView, camera: Intrinsics) -> FloatImage:
        """Return the linear light (H, W, 3) of a pinhole camera at the view's pose and time."""
        moved = [part.placed(pose_X_WR(*pose)) for part, pose in zip(self._moving, view.moving, strict=True)]
        triangles = Triangles.joined([self._still, self._robot.placed(pose_X_WR(*view.robot_pose)), *moved])
        X_WC = np.array(view.X_WC)
        seen = rasterise(camera, X_WC, triangles)
        hit = np.flatnonzero(seen.triangle >= 0)
        sky = from_sky(self._job.scene.sky)
        light = np.tile(sky.astype(np.float32), (camera.height_px * camera.width_px, 1))
        light[hit] = self._reflectance(triangles, seen, hit) * self._illuminance(camera, X_WC, triangles, seen, hit).T
        return light.reshape(camera.height_px, camera.width_px, 3)

    def _reflectance(self, triangles: Triangles, seen: VisibleTriangles, hit: Ints) -> Array:
        """Return the reflectance (N, 3) divided by pi of the pixels `hit` (N,)."""
        number, uv_m = triangles.surface[seen.triangle.ravel()[hit]], seen.uv_m.reshape(-1, 2)[hit]
        reflectance = np.zeros((len(number), 3))
        for surface in np.flatnonzero(np.bincount(number)):
            here = np.flatnonzero(number == surface)
            reflectance[here] = albedo(self._job.scene.surfaces[surface], uv_m[here], self._pixels) / np.pi
        return reflectance

    def _illuminance(
        self, camera: Intrinsics, X_WC: Array, triangles: Triangles, seen: VisibleTriangles, hit: Ints
    ) -> Array:
        """Return the illuminance (3, N) of the pixels `hit` (N,) on the visible side."""
        row, column = np.divmod(hit, camera.width_px)
        x, y = (column - camera.cx_px) / camera.fx_px, (row - camera.cy_px) / camera.fy_px
        ray = [a * x + b * y + c for a, b, c in X_WC[:3, :3]]
        depth = seen.depth_m.ravel()[hit]
        points = np.stack([eye + along * depth for eye, along in zip(X_WC[:3, 3], ray, strict=True)])
        normal = triangles.normals.T[:, seen.triangle.ravel()[hit]]
        away = normal[0] * ray[0] + normal[1] * ray[1] + normal[2] * ray[2] > 0
        normals = np.where(away, -normal, normal).astype(np.float32)
        scene = self._job.scene
        total = from_panels(scene.panels, points.astype(np.float32), normals) + self._all_around[:, None]
        if scene.sun is not None and self._shadow is not None:
            total += from_sun(scene.sun, normals, self._shadow.lit(points.T, normals.T))
        return total

"""Shadows of moving things in a small light: where they may lie on the floor, and how much of it they let through."""

from collections.abc import Sequence

import cv2
import numpy as np

from blender_scenes.hybrid.floor.sight import MIDDLE, FilterPoint, FloorSight
from blender_scenes.hybrid.shadows.casters import Caster, casters
from blender_scenes.hybrid.shadows.shadow_mask import ShadowMask, shadow_mask
from blender_scenes.hybrid.shadows.small_lights import SmallLight, on_floor
from blender_scenes.scene.description import Mesh
from sensors.camera.views import FrameView, Moment
from symolo.core.arrays import Array, FloatImage
from symolo.core.geometry.poses import pose_X_WR

_TEXEL_PX = 0.75
"""Size of a texel of a shadow, in pixels of the nearest floor that it may reach."""
_MIN_POINTS, _MAX_POINTS = 8, 64
"""Limits of the number of points of the light."""
_POINTS_PER_PX = 2
"""Number of these points for each pixel of the border's width."""
_MAX_DRAWN = 200_000
"""Number of shapes, each drawn once per point of the light, beyond which there are fewer points: half a second."""
_SPARE_TEXELS = 3
"""Texels around the floor in sight."""


class BodyShadows:
    """Shadows of the robot and of moving obstacles in one small light."""

    def __init__(self, light: SmallLight, on_robot: Sequence[Mesh], moving: Sequence[Mesh]) -> None:
        """Take a light above all of the meshes of the robot and of moving obstacles, which are in their frames."""
        self._light = light
        self._shapes = [casters(on_robot), *(casters([mesh]) for mesh in moving)]
        self._bodies = [
            np.concatenate([np.zeros((0, 3)), *(shape.corners for shape in shapes)]) for shapes in self._shapes
        ]

    def may_reach(self, view: FrameView, ground: FloatImage, spare_m: FloatImage) -> np.ndarray:
        """Return whether the floor at points (H, W, 2) in W is in a shadow, or nearer to one than `spare_m` (H, W).

        It counts the convex hull of each body's shadow with all of its border, at each moment of the exposure. Points
        with NaN are in none.
        """
        near = np.zeros(ground.shape[:2], bool)
        for moment in moments_of(view):
            for body, pose in zip(self._bodies, (moment.robot_pose, *moment.moving), strict=True):
                if len(body):
                    near |= _distance_m(self._shadow(body, pose_X_WR(*pose)), ground) < spare_m
        return near

    def visible_share(
        self,
        view: FrameView,
        sight: FloorSight,
        filters: Sequence[tuple[Sequence[FilterPoint], np.ndarray]],
        rows: slice,
    ) -> FloatImage:
        """Return the share (rows, W) of the light that reaches the floor in some rows of an image.

        Args:
            view: View.
            sight: Sight of the floor.
            filters: Points of the pixels' filter, and the pixels (H, W) that have them; each pixel has one.
            rows: Rows.
        """
        pixel_m = float(np.nanmin(sight.pixel_m()[0][rows]))
        moments = moments_of(view)
        share = np.ones(filters[0][1][rows].shape, np.float32)
        for number, (shapes, vertices) in enumerate(zip(self._shapes, self._bodies, strict=True)):
            if not shapes:
                continue
            poses = [(moment.robot_pose, *moment.moving)[number] for moment in moments]
            ground = sight.in_body(view, MIDDLE, poses, rows)
            mask = self._mask(shapes, vertices, pose_X_WR(*poses[len(poses) // 2]), ground, pixel_m)
            if mask is None:
                continue
            for points, where in filters:
                if where[rows].any():
                    seen = sum(mask.at(sight.in_body(view, point, poses, rows)) for point in points) / len(points)
                    share *= np.where(where[rows], seen, 1)
        return share

    def _mask(
        self, shapes: Sequence[Caster], vertices: Array, X_WB: Array, ground: FloatImage, pixel_m: float
    ) -> ShadowMask | None:
        """Return the shadow of a body on the ground (H, W, 2) in sight, in its frame; None if it is beside it."""
        border_m = self._light.border_m(vertices[:, 2].max())
        max_points = min(_MAX_POINTS, max(_MAX_DRAWN // len(shapes), _MIN_POINTS))
        count = int(np.clip(np.ceil(_POINTS_PER_PX * border_m / pixel_m), _MIN_POINTS, max_points))
        points = self._light.points(count) @ np.linalg.inv(X_WB).T
        ends = [on_floor(vertices, point) for point in points]
        spare_m = _SPARE_TEXELS * _TEXEL_PX * pixel_m
        low = np.maximum(np.min(ends, axis=(0, 1)), np.nanmin(ground, axis=(0, 1))) - spare_m
        high = np.minimum(np.max(ends, axis=(0, 1)), np.nanmax(ground, axis=(0, 1))) + spare_m
        return shadow_mask(shapes, points, low, high, _TEXEL_PX * pixel_m) if (low < high).all() else None

    def _shadow(self, body: Array, X_WB: Array) -> Array:
        """Return the corners (K, 2), counter-clockwise, of the hull of a body's shadow on the floor and its border."""
        vertices = body @ X_WB[:3, :3].T + X_WB[:3, 3]
        # A point of the light between its corners throws the shadow of a vertex between those that the corners throw.
        points = np.concatenate([on_floor(vertices, corner) for corner in self._light.corners()])
        hull = cv2.convexHull(points.astype(np.float32))[:, 0].astype(float)
        (x, y), (next_x, next_y) = hull.T, np.roll(hull, -1, axis=0).T
        return hull if np.sum(x * next_y - next_x * y) > 0 else hull[::-1]


def moments_of(view: FrameView) -> tuple[Moment, ...]:
    """Return the moments of the exposure, or the one of a view without an exposure time."""
    return view.exposure or (Moment(view.robot_pose, view.X_WC, view.moving),)


def _distance_m(hull: Array, points: FloatImage) -> FloatImage:
    """Return the distance (H, W) outside of the nearest edge's line, negative inside of the hull."""
    farthest = np.full(points.shape[:2], -np.inf)
    for corner, following in zip(hull, np.roll(hull, -1, axis=0), strict=True):
        along = following - corner
        out = np.array([along[1], -along[0]]) / max(float(np.linalg.norm(along)), 1e-9)
        farthest = np.maximum(farthest, (points - corner) @ out)
    return farthest

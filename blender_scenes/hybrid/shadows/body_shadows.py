"""Shadows of moving things in a small light: where they may lie on the floor, and how much of it they let through."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial

import cv2
import numpy as np

from blender_scenes.hybrid.floor.sight import FilterPoint, FloorSight
from blender_scenes.hybrid.shadows.casters import Caster, casters
from blender_scenes.hybrid.shadows.shadow_mask import enclosing, point_masks, shadow_mask, share_past_all
from blender_scenes.hybrid.shadows.small_lights import SmallLight, on_floor
from blender_scenes.scene.description import Mesh
from sensors.camera.views import FrameView, Moment
from symolo.core.arrays import Array, FloatImage
from symolo.core.geometry.poses import PlanarPose, pose_X_WR

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
        shares = []
        for number, poses in self._poses(view):
            seen = partial(sight.in_body, view, poses=poses, rows=rows)
            ends = _ends(filters, (rows, slice(None)), seen)
            if rectangle := self._rectangle(number, poses, ends, pixel_m, self._points(number, pixel_m)):
                share_at = partial(lambda mask, seen, point: mask.at(seen(point)), shadow_mask(*rectangle), seen)
                shares.append(_filtered(filters, (rows, slice(None)), share_at))
        share = np.ones(filters[0][1][rows].shape, np.float32)
        for each in shares:
            share *= each
        # Where one of the bodies hides all of the light or nothing of it, the product is right.
        borders = np.sum([(each > 0) & (each < 1) for each in shares], axis=0) > 1
        if np.any(borders):
            lines, columns = enclosing(borders)
            area = slice(rows.start + lines.start, rows.start + lines.stop), columns
            together = self._past_all(view, sight, filters, area, pixel_m)
            share[lines, columns] = np.where(borders[lines, columns], together, share[lines, columns])
        return share

    def _past_all(
        self,
        view: FrameView,
        sight: FloorSight,
        filters: Sequence[tuple[Sequence[FilterPoint], np.ndarray]],
        area: tuple[slice, slice],
        pixel_m: float,
    ) -> FloatImage:
        """Return the share (h, w) of the light that all bodies let through together in an area of the image."""
        rows, columns = area
        count = max(self._points(number, pixel_m) for number, _ in self._poses(view))
        bodies = []
        for number, poses in self._poses(view):
            ends = _ends(filters, area, partial(sight.in_body, view, poses=poses, rows=rows))
            if rectangle := self._rectangle(number, poses, ends, pixel_m, count):
                bodies.append((point_masks(*rectangle), poses))
        points, masks = len(self._light.points(count)), [of_body for of_body, _ in bodies]

        def at(point: FilterPoint) -> FloatImage:
            grounds = [sight.in_body(view, point, poses, rows)[:, columns] for _, poses in bodies]
            return share_past_all(points, masks, grounds)

        return _filtered(filters, area, at)

    def _poses(self, view: FrameView) -> Iterator[tuple[int, list[PlanarPose]]]:
        """Yield the number of each body with a shape, and its poses at the moments of the exposure."""
        for number, shapes in enumerate(self._shapes):
            if shapes:
                yield number, [(moment.robot_pose, *moment.moving)[number] for moment in moments_of(view)]

    def _points(self, number: int, pixel_m: float) -> int:
        """Return the number of points of the light for a body's shadow."""
        border_m = self._light.border_m(self._bodies[number][:, 2].max())
        max_points = min(_MAX_POINTS, max(_MAX_DRAWN // len(self._shapes[number]), _MIN_POINTS))
        return int(np.clip(np.ceil(_POINTS_PER_PX * border_m / pixel_m), _MIN_POINTS, max_points))

    def _rectangle(
        self, number: int, poses: Sequence[PlanarPose], seen: tuple[Array, Array], pixel_m: float, count: int
    ) -> tuple[list[Caster], Array, Array, Array, float] | None:
        """Return the arguments of `shadow_mask` for a body; None if its shadow is beside what is seen.

        `seen` has the lower left and the upper right corner (2,) of the ground in sight, in the frame of the body.
        """
        shapes, vertices = self._shapes[number], self._bodies[number]
        points = self._light.points(count) @ np.linalg.inv(pose_X_WR(*poses[len(poses) // 2])).T
        ends = [on_floor(vertices, point) for point in points]
        spare_m = _SPARE_TEXELS * _TEXEL_PX * pixel_m
        low = np.maximum(np.min(ends, axis=(0, 1)), seen[0]) - spare_m
        high = np.minimum(np.max(ends, axis=(0, 1)), seen[1]) + spare_m
        return (shapes, points, low, high, _TEXEL_PX * pixel_m) if (low < high).all() else None

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


def _ends(
    filters: Sequence[tuple[Sequence[FilterPoint], np.ndarray]],
    area: tuple[slice, slice],
    seen: Callable[[FilterPoint], FloatImage],
) -> tuple[Array, Array]:
    """Return the smallest and the largest place (2,) of the ground that the filters see in an area of the image.

    What moves during the exposure is elsewhere in its frame than in the middle of the exposure.
    """
    points = [point for points, where in filters if where[area].any() for point in points]
    low, high = np.full(2, np.nan), np.full(2, np.nan)
    for point in points:
        ground = seen(point)[:, area[1]]
        # Along one axis after the other takes a hundredth of the time of both at once.
        low = np.fmin(low, np.fmin.reduce(np.fmin.reduce(ground)))
        high = np.fmax(high, np.fmax.reduce(np.fmax.reduce(ground)))
    return low, high


def _filtered(
    filters: Sequence[tuple[Sequence[FilterPoint], np.ndarray]],
    area: tuple[slice, slice],
    share_at: Callable[[FilterPoint], FloatImage],
) -> FloatImage:
    """Return the mean (h, w) over the filter of each pixel of a share at its points, in an area of the image."""
    share = np.ones(filters[0][1][area].shape, np.float32)
    for points, where in filters:
        if where[area].any():
            share = np.where(where[area], sum(share_at(point) for point in points) / np.float32(len(points)), share)
    return share


def _distance_m(hull: Array, points: FloatImage) -> FloatImage:
    """Return the distance (H, W) outside of the nearest edge's line, negative inside of the hull."""
    farthest = np.full(points.shape[:2], -np.inf)
    for corner, following in zip(hull, np.roll(hull, -1, axis=0), strict=True):
        along = following - corner
        out = np.array([along[1], -along[0]]) / max(float(np.linalg.norm(along)), 1e-9)
        farthest = np.maximum(farthest, (points - corner) @ out)
    return farthest

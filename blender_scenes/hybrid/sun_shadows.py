"""Shadows of moving things in the sun: where they may lie on the floor, and how much of the sun they let through."""

from collections.abc import Sequence

import cv2
import numpy as np

from blender_scenes.scene.description import Mesh, Sun
from sensors.camera.views import FrameView, Moment
from symolo.core.arrays import Array, FloatImage
from symolo.core.geometry.poses import pose_X_WR

_NEAR_PX = 5
"""Side of the square from whose mean a pixel without any ray to the sun takes its value."""
_MIN_LIGHT = np.float32(1e-6)
_BLUR_PX = 0.5
"""Standard deviation of the blur of squares of pixels, for borders with few rays per pixel: with the 0.3 px of a square
it makes 0.6 px, a little more than the 0.4 px of the filter of Cycles."""


class SunShadows:
    def __init__(self, sun: Sun, on_robot: Sequence[Mesh], moving: Sequence[Mesh]) -> None:
        """Take the sun, and the meshes of the robot and of moving obstacles in their frames."""
        self._towards = np.array(sun.towards)
        self._bodies = [_vertices(on_robot), *(_vertices([mesh]) for mesh in moving)]

    def may_reach(self, view: FrameView, ground: FloatImage, spare_m: FloatImage) -> np.ndarray:
        """Return whether the floor at points (H, W, 2) in W is in a shadow, or nearer to one than `spare_m` (H, W).

        It counts the convex hull of each body's shadow at each moment of the exposure. Points with NaN are in none.
        """
        near = np.zeros(ground.shape[:2], bool)
        for moment in view.exposure or (Moment(view.robot_pose, view.X_WC, view.moving),):
            for body, pose in zip(self._bodies, (moment.robot_pose, *moment.moving), strict=True):
                if len(body):
                    near |= _distance_m(self._shadow(body, pose_X_WR(*pose)), ground) < spare_m
        return near

    def _shadow(self, body: Array, X_WB: Array) -> Array:
        """Return the corners (K, 2), counter-clockwise, of the hull of a body's shadow on the floor."""
        vertices = body @ X_WB[:3, :3].T + X_WB[:3, 3]
        points = vertices[:, :2] - vertices[:, 2:] * (self._towards[:2] / self._towards[2])
        hull = cv2.convexHull(points.astype(np.float32))[:, 0].astype(float)
        (x, y), (next_x, next_y) = hull.T, np.roll(hull, -1, axis=0).T
        return hull if np.sum(x * next_y - next_x * y) > 0 else hull[::-1]


def visible_share(moved: FloatImage, still: FloatImage) -> FloatImage:
    """Return the ratio (H, W, 1) of the sun's light (H, W, 3) with and without what moves; 1 where the sun is hidden.

    The lights are means of squares of pixels.

    Both have the same random numbers, so their ratio has no noise where a wall or a window's frame hides a part of the
    sun's disc. A pixel all of whose rays end there takes the ratio of its neighbours.
    """
    with_, without = (light.mean(axis=-1) for light in (moved, still))
    near_with, near_without = (cv2.blur(light, (_NEAR_PX, _NEAR_PX)) for light in (with_, without))
    nearby = np.where(near_without > _MIN_LIGHT, near_with / np.maximum(near_without, _MIN_LIGHT), 1)
    share = np.where(without > _MIN_LIGHT, with_ / np.maximum(without, _MIN_LIGHT), nearby)
    return cv2.GaussianBlur(share, (0, 0), _BLUR_PX)[..., None].astype(np.float32)


def _vertices(meshes: Sequence[Mesh]) -> Array:
    return np.concatenate([np.zeros((0, 3)), *(np.array(mesh.vertices, float) for mesh in meshes)])


def _distance_m(hull: Array, points: FloatImage) -> FloatImage:
    """Return the distance (H, W) outside of the nearest edge's line, negative inside of the hull."""
    farthest = np.full(points.shape[:2], -np.inf)
    for corner, following in zip(hull, np.roll(hull, -1, axis=0), strict=True):
        along = following - corner
        out = np.array([along[1], -along[0]]) / max(float(np.linalg.norm(along)), 1e-9)
        farthest = np.maximum(farthest, (points - corner) @ out)
    return farthest

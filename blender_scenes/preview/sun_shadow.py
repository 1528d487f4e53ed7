"""Shadows of the sun, from a depth image of the scene as the sun sees it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blender_scenes.preview.rasteriser import rasterise
from blender_scenes.preview.triangles import Triangles
from blender_scenes.scene.description import Sun
from symolo.core.arrays import Array
from symolo.core.geometry.pinhole import Intrinsics, project

_SIDE_PX = 512
_AWAY = 1000.0
"""Distance of the sun's camera in radii of the scene; its rays are parallel to a thousandth."""
_LIFT_PX = 1.5
"""Height in pixels above a surface at which its points are looked up, because it would shade itself otherwise."""


@dataclass(frozen=True)
class SunShadow:
    """Shadow map of the sun: the depths of the scene as the sun sees it."""

    camera: Intrinsics
    """Camera that looks along the rays of the sun from so far away that they are nearly parallel."""
    X_WC: Array
    """(4, 4) pose of the sun's camera."""
    depth_m: Array
    """(S, S) depths of the nearest surfaces."""
    lift_m: float
    """Distance above a surface at which its points are looked up, so that it does not shade itself [m]."""

    @classmethod
    def from_scene(cls, sun: Sun, scene: Triangles) -> "SunShadow":
        """Return the shadows of what stands still."""
        points = scene.corners.reshape(-1, 3)
        middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
        radius = float(np.linalg.norm(points - middle, axis=1).max())
        half, focal_px = 0.5 * (_SIDE_PX - 1), 0.5 * _SIDE_PX * _AWAY
        camera = Intrinsics(_SIDE_PX, _SIDE_PX, focal_px, focal_px, half, half)
        X_WC = _looking_back(np.array(sun.towards), middle, _AWAY * radius)
        return cls(camera, X_WC, rasterise(camera, X_WC, scene).depth_m, 2 * _LIFT_PX * radius / _SIDE_PX)

    def lit(self, points: Array, normals: NDArray[np.float32]) -> NDArray[np.bool_]:
        """Return whether the sun reaches points (N, 3) in W of surfaces with unit normals (N, 3)."""
        pixel, depth = project(self.camera, self.X_WC, points + self.lift_m * normals)
        column, row = np.clip(np.rint(pixel), 0, _SIDE_PX - 1).astype(np.intp).T
        return depth <= self.depth_m[row, column]


def _looking_back(towards: Array, middle: Array, distance_m: float) -> Array:
    """Return the pose (4, 4) of a camera that looks at `middle` from the direction of the sun."""
    across = np.array([1.0, 0.0, 0.0]) if abs(towards[2]) > 0.9 else np.array([0.0, 0.0, 1.0])
    right = np.cross(-towards, across)
    right /= np.linalg.norm(right)
    X_WC = np.eye(4)
    X_WC[:3, :3] = np.stack([right, np.cross(-towards, right), -towards], axis=1)
    X_WC[:3, 3] = middle + distance_m * towards
    return X_WC

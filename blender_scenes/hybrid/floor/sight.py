"""The points of the floor that the pixels of an image see, during the exposure and all over their filter."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sensors.camera.shutter import MOMENTS
from sensors.camera.views import FrameView
from symolo.core.arrays import Array, FloatImage
from symolo.core.geometry.pinhole import Intrinsics
from symolo.core.geometry.poses import PlanarPose, pose_X_WR

_MAX_BYTES = 128 * 2**20
"""Maximum size of the points that are cached from frame to frame."""
_POINTS = 3
"""Number of points of a pixel's filter from left to right."""
_CYCLES_FILTER = 2.0
"""Cycles' Blackman-Harris filter reaches this many half widths from the pixel's middle (scene/film.cpp)."""
_TURNS = (1, 6, 5, 8, 4, 0, 3, 2, 7)
"""Order in time of 3 x 3 points, row by row: a magic square, so that all sides of the filter have one mean time."""


@dataclass(frozen=True)
class FilterPoint:
    """A point of a pixel's filter."""

    right_px: float
    """Offset to the right of the pixel's middle."""
    down_px: float
    """Offset below the pixel's middle."""
    time: float
    """Time in its exposure, 0 to 1."""


MIDDLE = FilterPoint(0.0, 0.0, 0.5)


def filter_points(width_px: float, squares: int = 1) -> tuple[FilterPoint, ...]:
    """Return points with equal shares of Cycles' Blackman-Harris filter of that width, 3 x 3 for each square."""
    reach = 0.5 * _CYCLES_FILTER * width_px
    at = np.linspace(-reach, reach, 4001)
    turn = np.pi * (at / reach + 1)
    weight = 0.35875 - 0.48829 * np.cos(turn) + 0.14128 * np.cos(2 * turn) - 0.01168 * np.cos(3 * turn)
    # Points in the middle of equal shares of the filter, by its inverse distribution function: each counts the same.
    share = np.cumsum(weight) / weight.sum()
    across, down = (np.interp((np.arange(n) + 0.5) / n, share, at).tolist() for n in (_POINTS, squares * _POINTS))
    points = []
    for row, down_px in enumerate(down):
        # The squares' rows alternate; every other square is upside down.
        square, place = row % squares, row // squares
        turns = _TURNS[:: -1 if square % 2 else 1][place * _POINTS :][:_POINTS]
        times = [(turn * squares + square + 0.5) / (len(_TURNS) * squares) for turn in turns]
        points += [FilterPoint(right_px, down_px, time) for right_px, time in zip(across, times, strict=True)]
    return tuple(points)


class FloorSight:
    """Points of the floor, relative to the robot, that the pixels of its camera see."""

    def __init__(self, camera: Intrinsics, view: FrameView, row_share: float) -> None:
        """Take a camera without distortion, a view for its pose on the robot, and `row_share` of `shutter.Window`."""
        self._camera, self._row_share = camera, row_share
        self._X_RC = np.linalg.inv(pose_X_WR(*view.robot_pose)) @ np.array(view.X_WC)
        self._cache: dict[tuple[float, float], FloatImage] = {}
        self._max_cached = _MAX_BYTES // (2 * np.dtype(np.float32).itemsize * camera.width_px * camera.height_px)

    def depth_m(self) -> FloatImage:
        """Return the depth (H, W) of the floor in the middle of each pixel; NaN above the horizon."""
        return (-self._X_RC[2, 3] / self._rays(0.0, 0.0)[2]).astype(np.float32)

    def pixel_m(self) -> tuple[FloatImage, FloatImage]:
        """Return the size of the floor (H, W) that a pixel covers across and along the view; NaN above the horizon.

        At the depth z a pixel covers z^3 / (f^2 h) of a plane at the distance h, and z / f across.
        """
        depth_m = self.depth_m()
        across_m = depth_m / self._camera.fx_px
        return across_m, across_m * depth_m / np.float32(self._X_RC[2, 3])

    def points(self, view: FrameView, point: FilterPoint, rows: slice = slice(None)) -> FloatImage:
        """Return x and y in W (H, W, 2) [m] of the floor that pixels see, in some rows; NaN above the horizon."""
        x, y, yaw = (values[rows, None] for values in self._robot_poses(view, point.time))
        ahead, left = self._in_robot(point.right_px, point.down_px, rows)
        cosine, sine = np.cos(yaw).astype(np.float32), np.sin(yaw).astype(np.float32)
        points = np.empty((2, *ahead.shape), np.float32)
        points[0] = cosine * ahead - sine * left + x.astype(np.float32)
        points[1] = sine * ahead + cosine * left + y.astype(np.float32)
        return np.moveaxis(points, 0, -1)

    def in_body(
        self, view: FrameView, point: FilterPoint, poses: Sequence[PlanarPose], rows: slice = slice(None)
    ) -> FloatImage:
        """Return `points` in the frame of a body with these poses at the moments of the exposure."""
        x, y, yaw = (values[rows, None].astype(np.float32) for values in self._poses(poses, point.time))
        right, up = np.moveaxis(self.points(view, point, rows), -1, 0)
        right, up, cosine, sine = right - x, up - y, np.cos(yaw), np.sin(yaw)
        return np.stack([cosine * right + sine * up, cosine * up - sine * right], axis=-1)

    def _robot_poses(self, view: FrameView, time: float) -> tuple[Array, Array, Array]:
        return self._poses([moment.robot_pose for moment in view.exposure] or [view.robot_pose], time)

    def _poses(self, poses: Sequence[PlanarPose], time: float) -> tuple[Array, Array, Array]:
        """Return x, y and yaw (H,) at a share of each row's exposure; `shutter.window` explains Cycles' shutter."""
        rows = self._camera.height_px
        if len(poses) == 1:
            x, y, yaw = poses[0]
            return np.full(rows, x), np.full(rows, y), np.full(rows, yaw)
        middle = 0.5 + ((np.arange(rows) + 1) / rows - 0.5) * (1 - self._row_share)
        at = middle + (time - 0.5) * self._row_share
        x, y, yaw = np.array(poses).T
        known = np.linspace(0.0, 1.0, MOMENTS)
        return np.interp(at, known, x), np.interp(at, known, y), np.interp(at, known, np.unwrap(yaw))

    def _in_robot(self, right_px: float, down_px: float, rows: slice) -> FloatImage:
        """Return x and y in R (2, rows, W), equal in every frame; large images keep those of some points only."""
        at = right_px, down_px
        if at not in self._cache and len(self._cache) < self._max_cached:
            self._cache[at] = self._seen_in_robot(*at, slice(None))
        return self._cache[at][:, rows] if at in self._cache else self._seen_in_robot(*at, rows)

    def _seen_in_robot(self, right_px: float, down_px: float, rows: slice) -> FloatImage:
        ahead, left, down = self._rays(right_px, down_px, rows)
        reach = self._X_RC[2, 3] / down
        x_m, y_m = self._X_RC[:2, 3]
        return np.stack([x_m - reach * ahead, y_m - reach * left], dtype=np.float32, casting="same_kind")

    def _rays(self, right_px: float, down_px: float, rows: slice = slice(None)) -> tuple[Array, Array, Array]:
        """Return x, y and z in R (rows, W) of each pixel's ray of depth 1; z is NaN where it misses the floor."""
        camera = self._camera
        x = (np.arange(camera.width_px) + right_px - camera.cx_px) / camera.fx_px
        y = (np.arange(camera.height_px)[rows] + down_px - camera.cy_px) / camera.fy_px
        ahead, left, down = (a * x + (b * y + c)[:, None] for a, b, c in self._X_RC[:3, :3])
        return ahead, left, np.where(down < -1e-6, down, np.nan)

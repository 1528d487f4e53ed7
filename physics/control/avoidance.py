"""The path beside an obstacle: a pre-computed spline followed by pure pursuit on odometry (section 4.3, Fig. 7a)."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from configs.schema.robot import Avoidance
from physics.control.base import Side

Pose = tuple[float, float, float]


@dataclass(frozen=True)
class AvoidancePath:
    """A path in the frame of the robot where avoidance began: x forward, y left."""

    points: NDArray[np.float64]
    """(N, 2) [m], evenly spaced along the path."""
    spacing_m: float
    back_begins: int
    """Index of the first point of the way back."""

    @property
    def length_m(self) -> float:
        return self.spacing_m * (len(self.points) - 1)


def straight_path(config: Avoidance, side: Side) -> AvoidancePath:
    """Out to the side, along the obstacle, back to the line or wall; mirrored for the right-hand side."""
    x_out = config.out_length_m
    x_back = x_out + config.along_length_m
    x_end = x_back + config.back_length_m
    # Flat at every knot, so that the path leaves, passes and meets the line in the direction of travel.
    spline = CubicHermiteSpline([0.0, x_out, x_back, x_end], [0.0, config.side_m, config.side_m, 0.0], np.zeros(4))
    x_fine = np.linspace(0.0, x_end, 8 * config.points)
    y_fine = spline(x_fine)
    travelled = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x_fine), np.diff(y_fine)))])
    even = np.linspace(0.0, travelled[-1], config.points)
    x = np.interp(even, travelled, x_fine)
    sign = 1.0 if side == "left" else -1.0
    points = np.stack([x, sign * spline(x)], axis=1)
    points.flags.writeable = False
    return AvoidancePath(points, float(even[1]), int(np.searchsorted(x, x_back)))


class PathFollower:
    """Pure pursuit along an avoidance path from where the robot stands, on odometry.

    While the obstacle is still beside the robot at the end of the stretch along it, the way back is put off: the rest
    of the path moves forward with the robot.
    """

    def __init__(self, path: AvoidancePath, start: Pose, look_ahead_m: float) -> None:
        self._path = path
        self._start = start
        self._look_ahead_m = look_ahead_m
        self._nearest = 0
        self._shift_m = 0.0

    @property
    def finished(self) -> bool:
        return self._nearest >= len(self._path.points) - 2

    @property
    def on_the_way_back(self) -> bool:
        return self._nearest >= self._path.back_begins

    def step(self, odometry: Pose, *, obstacle_beside: bool) -> float:
        """Curvature [1/m] to drive at, positive to the left, for the robot's pose by odometry."""
        x, y, yaw = self._in_path_frame(odometry)
        if obstacle_beside and not self.on_the_way_back:
            at_back_begins = self._path.points[self._path.back_begins, 0] + self._shift_m
            self._shift_m += max(0.0, x - at_back_begins + self._look_ahead_m)
        points = self._path.points
        window = points[self._nearest : self._nearest + _points_in(3 * self._look_ahead_m, self._path)]
        distance = np.hypot(window[:, 0] + self._shift_m - x, window[:, 1] - y)
        self._nearest += int(np.argmin(distance))
        goal = points[min(self._nearest + _points_in(self._look_ahead_m, self._path), len(points) - 1)]
        beyond_m = max(0.0, self._look_ahead_m - self._path.spacing_m * (len(points) - 1 - self._nearest))
        ahead = (goal[0] + self._shift_m + beyond_m - x, goal[1] - y)
        lateral = -math.sin(yaw) * ahead[0] + math.cos(yaw) * ahead[1]
        return 2.0 * lateral / max(ahead[0] ** 2 + ahead[1] ** 2, 1e-6)

    def _in_path_frame(self, odometry: Pose) -> Pose:
        dx, dy = odometry[0] - self._start[0], odometry[1] - self._start[1]
        c, s = math.cos(self._start[2]), math.sin(self._start[2])
        return c * dx + s * dy, c * dy - s * dx, odometry[2] - self._start[2]


def _points_in(length_m: float, path: AvoidancePath) -> int:
    return max(1, round(length_m / path.spacing_m))

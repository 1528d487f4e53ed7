"""A path beside an obstacle, followed by pure pursuit on odometry (paper section 4.3)."""

import math

import numpy as np

from physics.control.paths import AvoidancePath
from symolo.core.geometry.poses import PlanarPose


class PathFollower:
    """Pure pursuit along an avoidance path that starts at the robot's pose, based on odometry.

    If the obstacle is still beside the robot at the end of the stretch along it, the return is delayed: the rest of the
    path moves forward with the robot.
    """

    def __init__(self, path: AvoidancePath, start: PlanarPose, look_ahead_m: float) -> None:
        self._path = path
        self._start = start
        self._look_ahead_m = look_ahead_m
        self._nearest = 0
        self._shift_m = 0.0

    @property
    def finished(self) -> bool:
        return self._nearest >= len(self._path.points) - 2

    @property
    def is_returning(self) -> bool:
        return self._nearest >= self._path.back_begins

    def step(self, odometry: PlanarPose, *, obstacle_beside: bool) -> float:
        """Return the curvature [1/m] to drive at, positive to the left, for a pose from odometry."""
        ahead = self._goal(odometry, obstacle_beside=obstacle_beside)
        yaw = odometry[2] - self._start[2]
        lateral = -math.sin(yaw) * ahead[0] + math.cos(yaw) * ahead[1]
        # The circle through the robot, tangent to its heading, and the goal: curvature 2 y / d^2.
        return 2.0 * lateral / max(ahead[0] ** 2 + ahead[1] ** 2, 1e-6)

    def bearing(self, odometry: PlanarPose) -> float:
        """Return the direction [rad] of the goal point relative to the robot's heading, positive to the left."""
        ahead = self._goal(odometry, obstacle_beside=False)
        return math.remainder(math.atan2(ahead[1], ahead[0]) - odometry[2] + self._start[2], 2.0 * math.pi)

    def _goal(self, odometry: PlanarPose, *, obstacle_beside: bool) -> tuple[float, float]:
        """Return the vector [m] from the robot to the point one look-ahead further along the path, in path axes."""
        x, y = self._in_path_frame(odometry)
        if obstacle_beside and not self.is_returning:
            at_back_begins = self._path.points[self._path.back_begins, 0] + self._shift_m
            self._shift_m += max(0.0, x - at_back_begins + self._look_ahead_m)
        points = self._path.points
        window = points[self._nearest : self._nearest + _points_in(3 * self._look_ahead_m, self._path)]
        distance = np.hypot(window[:, 0] + self._shift_m - x, window[:, 1] - y)
        self._nearest += int(np.argmin(distance))
        goal = points[min(self._nearest + _points_in(self._look_ahead_m, self._path), len(points) - 1)]
        beyond_m = max(0.0, self._look_ahead_m - self._path.spacing_m * (len(points) - 1 - self._nearest))
        return float(goal[0] + self._shift_m + beyond_m - x), float(goal[1] - y)

    def _in_path_frame(self, odometry: PlanarPose) -> tuple[float, float]:
        dx, dy = odometry[0] - self._start[0], odometry[1] - self._start[1]
        c, s = math.cos(self._start[2]), math.sin(self._start[2])
        return c * dx + s * dy, c * dy - s * dx


def _points_in(length_m: float, path: AvoidancePath) -> int:
    return max(1, round(length_m / path.spacing_m))

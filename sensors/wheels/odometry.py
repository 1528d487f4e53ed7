"""Wheel odometry: the pose that the robot estimates from its encoder counts alone."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from symolo.core.geometry.poses import PlanarPose


@dataclass(frozen=True)
class Odometry:
    """Differential-drive dead reckoning by the mid-point rule (paper Eq. 1-5)."""

    metres_per_count: float
    track_m: float

    @classmethod
    def from_config(cls, robot: RobotConfig) -> "Odometry":
        circumference = np.pi * robot.drive.wheel_diameter_m
        return cls(circumference / robot.encoder.counts_per_revolution, robot.drive.track_m)

    def step(self, pose: PlanarPose, counts: NDArray[np.int64]) -> PlanarPose:
        """Return the pose x [m], y [m], yaw [rad] after the increments `counts` (2,) of right and left encoder."""
        right_m, left_m = float(counts[0]) * self.metres_per_count, float(counts[1]) * self.metres_per_count
        x, y, yaw = pose
        forward_m, turn_rad = 0.5 * (right_m + left_m), (right_m - left_m) / self.track_m
        middle = yaw + 0.5 * turn_rad
        return x + forward_m * float(np.cos(middle)), y + forward_m * float(np.sin(middle)), yaw + turn_rad

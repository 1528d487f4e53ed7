"""Line and wall following: one control law for two errors (paper sections 4, 4.1 and 4.2)."""

import math
from collections.abc import Sequence

from configs.schema.controller import FollowGains, WallFollowing

MAX_ERROR = 3.5
"""Outermost channel of the line sensor; the wall error saturates there too when the robot is too close."""


def line_error(line: Sequence[float], threshold: float) -> float | None:
    """Return the mean weight of the channels on the line (Eq. 12), positive to the left; None if there is none."""
    middle = 0.5 * (len(line) - 1)
    active = [i - middle for i, reading in enumerate(line) if reading < threshold]
    return sum(active) / len(active) if active else None


def wall_error(measured_m: float, config: WallFollowing) -> float:
    """Return the wall error (Eq. 13-14), scaled and saturated to the line error's range; positive if too close."""
    actual_m = math.cos(math.radians(45.0)) * measured_m
    error = config.error_scale_per_m * (config.target_distance_m - actual_m)
    return max(-config.far_error_limit, min(MAX_ERROR, error))


def follow(error: float, gains: FollowGains) -> tuple[float, float]:
    """Return v = K1 - K3 |e| [m/s] and w = K2 e [rad/s] (Eq. 6-7)."""
    return max(0.0, gains.k1_m_s - gains.k3_m_s * abs(error)), gains.k2_rad_s * error

"""The noise of a path that is computed from encoder counts, from the first pose on."""

from collections.abc import Sequence

import numpy as np

from diagnosis.predictors.pose.pose_noise import PoseNoise
from symolo.core.arrays import Array


def path_sd(path: Array, travel_m: Array, trials: Sequence[int], noise: PoseNoise, track_m: float) -> Array:
    """Return the standard deviations (3, n) of x [m], y [m] and yaw [rad] of a path, as a camera logs them.

    The slip of each wheel makes a random error of distance and heading in each row, and an error of the heading moves
    all later places. The first pose and the pose of the row have the noise of the camera (propagation of errors in
    dead reckoning: Kelly, Int. J. Robotics Research 23 (2004) 179-218).

    Args:
        path: (n, 3), x [m], y [m], yaw [rad] of all rows.
        travel_m: (n,), mean distance that both wheels have travelled since the row before; 0 in the first of a trial.
        trials: Number of rows of each trial.
        noise: Noise of poses and wheels.
        track_m: Distance between the wheels.
    """
    sds, begin = np.empty((3, len(path))), 0
    for rows in trials:
        part = slice(begin, begin + rows)
        begin += rows
        (x, y), yaw = path[part, :2].T - path[begin - rows, :2, None], path[part, 2]
        slip = noise.slip_m_per_sqrt_m**2 * travel_m[part]
        forward, turn = 0.5 * slip, 2.0 * slip / track_m**2
        turn[0] += noise.theta_rad**2
        total, by_x, by_y = np.cumsum(turn), np.cumsum(turn * x), np.cumsum(turn * y)
        along = np.stack([np.cumsum(forward * np.cos(yaw) ** 2), np.cumsum(forward * np.sin(yaw) ** 2)])
        across = np.stack(
            [
                y**2 * total - 2.0 * y * by_y + np.cumsum(turn * y**2),
                x**2 * total - 2.0 * x * by_x + np.cumsum(turn * x**2),
            ]
        )
        sds[:2, part] = np.sqrt(2.0 * noise.xy_m**2 + along + np.maximum(across, 0.0))
        sds[2, part] = np.sqrt(total + noise.theta_rad**2)
    return sds

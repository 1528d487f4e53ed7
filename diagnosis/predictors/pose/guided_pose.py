"""Poses of a log at any time, smoothed beside the path that the wheels turned.

A camera's pose has noise, and a few of its poses are wrong. A parabola through several rows averages the noise
(`smoothed_pose`), but it cuts the corners of a robot that turns quickly. The counts of the wheels follow such a turn
and hardly have noise, but they drift. So the difference between the two is smoothed, which changes slowly, and poses
that are far from their neighbours do not count.
"""

from collections.abc import Sequence
from math import pi

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from diagnosis.measured.channel import Mask
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.pose.by_counts import SIDES
from diagnosis.predictors.pose.delayed_pose import earlier
from diagnosis.predictors.pose.pose_noise import PoseNoise
from diagnosis.predictors.pose.smoothed_pose import smoothed_earlier
from diagnosis.predictors.rows import bridged, good_values, joined
from symolo.core.arrays import Array

MEDIAN_ROWS = 7
"""Rows of the running median, beside which a wrong pose shows."""
WRONG = 5.0
"""Distance from the running median, in standard deviations of it, from which a pose is wrong."""
NORMAL = 1.4826
"""Standard deviation of a normal distribution over its median absolute deviation."""


class GuidedPoses:
    """Logged poses of all trials beside the steps of the wheels."""

    def __init__(  # noqa: PLR0917 - a log and what is known of it
        self, pose: Array, is_logged: Mask, t_s: Array, trials: Sequence[int], steps: Array, noise: PoseNoise
    ) -> None:
        """
        Args:
            pose: (n, 3), logged poses, interpolated where there is none.
            is_logged: (n,), rows with a pose.
            t_s: (n,), times of the rows.
            trials: Number of rows of each trial.
            steps: (n, 2), distance forward [m] and turn [rad] since the row before, by the wheels; zeros if the wheels
                say nothing.
            noise: Stated noise of the poses, within which no pose is wrong.
        """
        self._t_s, self._trials = t_s, trials
        trial = np.repeat(np.arange(len(trials)), trials)
        forward_m, turn_rad = steps.T
        turned_rad = np.cumsum(turn_rad)
        drift_rad = pose[:, 2] - turned_rad
        wrong = _wrong(drift_rad[:, None], trial, is_logged, noise.theta_rad)
        yaw_rad = turned_rad + self._smoothed(drift_rad[:, None], ~wrong, 0.0)[:, 0]
        middle_rad = yaw_rad - 0.5 * turn_rad
        ahead = np.stack([forward_m * np.cos(middle_rad), forward_m * np.sin(middle_rad)], axis=-1)
        self._path = np.concatenate([np.cumsum(ahead, axis=0), turned_rad[:, None]], axis=-1)
        """(n, 3), path by the wheels, at the smoothed headings."""
        self._drift = pose - self._path
        """(n, 3), what the wheels do not say."""
        self.is_right: Mask = ~(wrong | _wrong(self._drift[:, :2], trial, is_logged, noise.xy_m))
        """(n,), rows whose logged pose is near those around."""
        self._known: tuple[bytes, Array] = (b"", pose)

    def at(self, delay_s: float | Array) -> Array:
        """Return the poses (..., n, 3) a delay before the times of their rows; delays as of `earlier`.

        Most robots have the delay of the one before, so its poses are remembered; of several robots, all but one or two
        have the same delay.
        """
        if np.ndim(delay_s) > 1:
            different, which = np.unique(delay_s, axis=0, return_inverse=True)
            return self._earlier(different)[which]
        key = np.asarray(delay_s).tobytes()
        if key != self._known[0]:
            poses = self._earlier(delay_s)
            poses.flags.writeable = False
            self._known = key, poses
        return self._known[1]

    def _earlier(self, delay_s: float | Array) -> Array:
        path = earlier(self._path, self._t_s, self._trials, delay_s)
        return path + self._smoothed(self._drift, self.is_right, delay_s)

    def _smoothed(self, values: Array, trusted: Mask, delay_s: float | Array) -> Array:
        return smoothed_earlier(values, self._t_s, self._trials, delay_s, trusted)


def wheel_steps(measurement: Measurement, nominal: RobotConfig) -> Array | None:
    """Return distance forward [m] and turn [rad] since the row before, (n, 2), by the counts of the nominal robot.

    They are zeros if a count is coarser than the noise of the poses, and None if there are no counts.
    """
    trials = [len(trial.t_s) for trial in measurement.trials]
    counts = np.stack([good_values(measurement, f"enc_{side}_ticks") for side in SIDES], axis=-1)
    if not np.isfinite(counts).all(axis=-1).any():
        return None
    per_count_m = pi * nominal.drive.wheel_diameter_m / nominal.encoder.counts_per_revolution
    noise = PoseNoise.from_measurement(measurement)
    is_coarse = per_count_m > noise.xy_m or per_count_m / nominal.drive.track_m > noise.theta_rad
    if is_coarse:
        return np.zeros((len(counts), 2))
    rolled_m = per_count_m * bridged(counts, joined(trial.t_s for trial in measurement.trials), trials)
    right_m, left_m = np.diff(rolled_m, axis=0, prepend=rolled_m[:1]).T
    steps = np.stack([0.5 * (right_m + left_m), (right_m - left_m) / nominal.drive.track_m], axis=-1)
    steps[np.cumsum([0, *trials[:-1]])] = 0.0
    return steps


def _wrong(values: Array, trial: NDArray[np.int64], is_logged: Mask, min_sd: float) -> Mask:
    """Return the rows (n,) without a pose, or with values (n, k) far from the median of the rows around.

    Their noise is estimated from the values themselves, and is at least `min_sd`.
    """
    wrong = ~is_logged
    for k in np.unique(trial).tolist():
        rows = np.flatnonzero((trial == k) & is_logged)
        if len(rows) < MEDIAN_ROWS:
            continue
        around = np.clip(np.arange(len(rows))[:, None] + np.arange(MEDIAN_ROWS) - MEDIAN_ROWS // 2, 0, len(rows) - 1)
        off = np.abs(values[rows] - np.median(values[rows][around], axis=1))
        sd = NORMAL * np.median(off, axis=0)
        wrong[rows[np.any(off > WRONG * np.maximum(sd, min_sd), axis=-1)]] = True
    return wrong

"""The pose of the axle from the logged pose, by the effects of what tracks the robot."""

from collections.abc import Sequence

import numpy as np

from configs.effects.base import Slot
from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.case_format import POSE
from diagnosis.measured.channel import Mask
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.pose.delayed_pose import earlier
from diagnosis.predictors.pose.guided_pose import GuidedPoses
from diagnosis.predictors.pose.heading_error import heading_error_rad, turned_by
from diagnosis.predictors.pose.pose_noise import PoseNoise
from diagnosis.predictors.pose.smoothed_pose import smoothed_earlier
from diagnosis.predictors.rows import bridged, good_values, joined, session_time_s
from physics.robot.model import applied
from physics.robot.stack import stacked_effects
from symolo.core.arrays import Array


class TrackedAxle:
    """Logged poses of all trials, interpolated between rows, smoothed, or smoothed beside the steps of the wheels."""

    def __init__(self, measurement: Measurement, *, is_smoothed: bool = False, steps: Array | None = None) -> None:
        """
        Args:
            measurement: The log.
            is_smoothed: Whether the poses are smoothed by themselves.
            steps: (n, 2), distance forward [m] and turn [rad] since the row before by the wheels, beside which the
                poses are smoothed.
        """
        self._earlier = smoothed_earlier if is_smoothed else earlier
        self._trials = [len(trial.t_s) for trial in measurement.trials]
        self._t_s = joined(trial.t_s for trial in measurement.trials)
        self._since_on_s = session_time_s(measurement)
        logged = np.stack([good_values(measurement, name) for name in POSE], axis=-1)
        self.is_logged = np.isfinite(logged).all(axis=-1)
        """(n,), rows with a pose."""
        self.pose = bridged(logged, self._t_s, self._trials)
        """(n, 3), logged x [m], y [m], yaw [rad]; between two rows with a pose, it is interpolated."""
        self._guided: GuidedPoses | None = None
        if steps is not None:
            noise = PoseNoise.from_measurement(measurement)
            self._guided = GuidedPoses(self.pose, self.is_logged, self._t_s, self._trials, steps, noise)

    @property
    def is_guided(self) -> bool:
        """Whether the poses are smoothed beside the steps of the wheels."""
        return self._guided is not None

    @property
    def is_right(self) -> Mask:
        """(n,), rows with a pose that is not known to be wrong."""
        return self.is_logged if self._guided is None else self._guided.is_right

    def at(self, robots: Sequence[RobotConfig], age_s: float | Array) -> Array:
        """Return the poses of the axles an age before the times of the rows, (n, 3) or (M, n, 3)."""
        # The logged pose is older than its row by the pose delay.
        pose_delay_s = applied(stacked_effects(robots, axes=1).functions(Slot.POSE_DELAY), 0.0, self._t_s)
        delay_s = age_s - pose_delay_s
        if self._guided is not None:
            tracked = self._guided.at(delay_s)
        else:
            tracked = self._earlier(self.pose, self._t_s, self._trials, delay_s)
        point = stacked_effects(robots, axes=2).functions(Slot.POSE_POINT)
        # The effects turn every axle by the same angle and shift it by a vector that depends on its yaw only. So one
        # step back from the tracked pose gives the yaw of the axle, and a second one its place.
        if functions := stacked_effects(robots, axes=1).functions(Slot.POSE_HEADING):
            askew_rad = applied(point, np.zeros((1, 3)))[..., 2]
            error_rad = heading_error_rad(functions, tracked[..., 2] - askew_rad, self._since_on_s)
            tracked = turned_by(tracked, -error_rad)
        axle = 2.0 * tracked - applied(point, tracked)
        return axle + (tracked - applied(point, axle))

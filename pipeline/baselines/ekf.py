"""Extended Kalman filter: odometry, corrected by ToF readings that agree with the map (Thrun, Burgard and Fox,
Probabilistic Robotics, 2005, sections 3.3 and 7.4).

Beside pose and wheels the state has the errors that last for a run: of each ToF sensor a gain, an offset, and the angle
by which it is turned in its mount; and an offset for each wall and obstacle. If the filter took these errors for new
noise in every reading, it would become overconfident in a wrong pose.
"""

from collections.abc import Sequence

import numpy as np

from pipeline.baselines.base import Method, TrainingRun
from pipeline.baselines.motion import STATES, WheelMotion, initial_state, rolled_distances_m
from pipeline.baselines.range_model import GAIN_SD, LASTING_SD_M, MOUNT_SD_RAD, OFFSET_SD_M, RangeModel, white_sd_m
from pipeline.baselines.robot_knowledge import RobotKnowledge
from sensors.ranging.tof import log_error_m
from symolo.core.arrays import Array
from symolo.evaluation.estimate import Estimate

RAYS = 30
BEAM_SHARE = 0.1
"""Standard deviation of the error of an expected range as a share of the spread of its rays: a data sheet has the width
of a beam and not how the light falls off towards its edge (assumed)."""
GATE = 6.635
"""99 % quantile of chi-square with one degree of freedom; less likely readings come from objects that are on no map."""
MIN_STEP = np.array([0.002, 0.002, 0.01])
"""Smallest steps of the numerical derivatives by x [m], y [m], yaw [rad]. Larger steps are the standard deviations of
the pose."""
WIDTH = 3.0
"""Square of the step of the differences, in standard deviations; 3 is best for a Gaussian (Norgaard, see below)."""


def updated(state: Array, covariance: Array, row: Array, innovation: float, variance: float) -> tuple[Array, Array]:
    """Update a Kalman state by one scalar reading.

    Args:
        state: State, (n,).
        covariance: Covariance of the state, (n, n).
        row: Jacobian of the reading by the state, (n,).
        innovation: The reading minus the expected one.
        variance: Variance of the noise of the reading.

    Returns:
        State and covariance after the update; Joseph's form keeps the covariance symmetric and positive.
    """
    gain = covariance @ row / (row @ covariance @ row + variance)
    remaining = np.eye(len(state)) - np.outer(gain, row)
    return state + gain * innovation, remaining @ covariance @ remaining.T + variance * np.outer(gain, gain)


class KalmanFilter:
    """Extended Kalman filter of a robot with ranges and a map."""

    def __init__(self, knowledge: RobotKnowledge, further_sd: Array | None = None) -> None:
        """Begin at the start.

        The state has the pose and wheels, further numbers (K,) of these standard deviations, gain, offset and turn of
        each sensor, and the offset of the floor and of each wall and obstacle. Only pose and wheels change by moving.
        """
        self._motion = WheelMotion.from_knowledge(knowledge)
        self._ranges = RangeModel(knowledge, RAYS)
        self._mounts_R = np.array([[mount.x_m, mount.y_m] for mount in knowledge.drawing.mounts])
        further = np.zeros(0) if further_sd is None else further_sd
        sensors_sd = np.repeat([GAIN_SD, OFFSET_SD_M, MOUNT_SD_RAD], 3)
        surfaces_sd = np.full(1 + len(knowledge.map.boxes), LASTING_SD_M)
        moving, covariance = initial_state(knowledge.start)
        constant_sd = np.concatenate([further, sensors_sd, surfaces_sd])
        self._gain = STATES + len(further)
        self._offset, self._turn, self._surface = self._gain + np.array([3, 6, 9])
        self.state = np.concatenate([moving, np.zeros(len(constant_sd))])
        self.covariance = np.diag(np.concatenate([np.zeros(STATES), constant_sd**2]))
        self.covariance[:STATES, :STATES] = covariance
        self._speed = np.zeros(3)

    def predict(self, rolled_m: Array, duration_s: float) -> None:
        by_state, by_rolled = np.eye(len(self.state)), np.zeros((len(self.state), 2))
        by_state[:STATES, :STATES], by_rolled[:STATES] = self._motion.jacobians(self.state[:STATES], rolled_m)
        noise = (by_rolled * self._motion.slip_sd_m(rolled_m) ** 2) @ by_rolled.T
        self.covariance = by_state @ self.covariance @ by_state.T + noise
        moved = self._motion.moved(self.state[:STATES], rolled_m)
        if duration_s > 0.0:
            self._speed = (moved - self.state[:STATES])[:3] / duration_s
        self.state[:STATES] = moved

    def correct(self, ranges_m: Array) -> None:
        """Update the state by readings (3,) [m], nan where there is none."""
        if np.isnan(ranges_m).all():
            return
        at = self.state[:3].copy()
        expected_m, slopes, bend_m = self._expected(at)
        view = self._ranges.view(at - self._ranges.age_s * self._speed)
        for sensor in np.flatnonzero(~np.isnan(ranges_m + expected_m)).tolist():
            mean_m, slope = float(expected_m[sensor]), slopes[sensor]
            row = np.zeros(len(self.state))
            row[:3] = slope
            row[self._gain + sensor] = log_error_m(expected_m[sensor])
            row[self._offset + sensor] = 1.0
            row[self._turn + sensor] = slope[2] - slope[:2] @ self._swing_m(sensor, at[2])
            row[self._surface :] = view.share[sensor]
            late_m = slope @ self._speed * self._ranges.age_sd_s
            beam_m = BEAM_SHARE * view.spread_m[sensor]
            variance = float(white_sd_m(mean_m) ** 2 + late_m**2 + bend_m[sensor] ** 2 + beam_m**2)
            moved = np.concatenate([self.state[:3] - at, self.state[3:]])
            innovation = float(ranges_m[sensor] - mean_m - row @ moved)
            if innovation**2 <= GATE * float(row @ self.covariance @ row + variance):
                self.state, self.covariance = updated(self.state, self.covariance, row, innovation, variance)

    def _swing_m(self, sensor: int, yaw_rad: float) -> Array:
        """Return the derivative (2,) of the place of a sensor in W by the heading [m/rad]."""
        x, y = self._mounts_R[sensor]
        return np.array([-np.sin(yaw_rad) * x - np.cos(yaw_rad) * y, np.cos(yaw_rad) * x - np.sin(yaw_rad) * y])

    def _expected(self, at: Array) -> tuple[Array, Array, Array]:
        """Return mean ranges (3,), their Jacobian (3, 3) by x, y, yaw, and the deviations (3,) of their nonlinear part.

        The differences are as wide as the pose is uncertain (the filter DD2 of Norgaard, Poulsen and Ravn, "New
        developments in state estimation for nonlinear systems", Automatica 36 (2000) 1627-1638). The deviation is large
        where an edge of the map may be in the beam. All results of a sensor are nan where there may be no target.
        """
        root = np.linalg.cholesky(self.covariance[:3, :3] + np.diag(MIN_STEP**2))
        moves = np.sqrt(WIDTH) * np.concatenate([np.zeros((3, 1)), root, -root], axis=1).T
        here, *around = self._ranges.expected(at - self._ranges.age_s * self._speed + moves)
        ahead, behind = np.array(around[:3]), np.array(around[3:])
        bends = (ahead + behind - 2.0 * here) / WIDTH
        slopes = np.linalg.solve(root.T, (ahead - behind) / (2.0 * np.sqrt(WIDTH)))
        return here + 0.5 * bends.sum(axis=0), slopes.T, 0.5 * np.sqrt((WIDTH - 1.0) * (bends**2).sum(axis=0))


def _estimate(knowledge: RobotKnowledge, _training_runs: Sequence[TrainingRun], _rng: np.random.Generator) -> Estimate:
    ekf = KalmanFilter(knowledge)
    poses, covariances = [], []
    readings = np.where(knowledge.fresh, knowledge.ranges_m, np.nan)
    for rolled_m, duration_s, ranges_m in zip(
        rolled_distances_m(knowledge), np.diff(knowledge.t_s, prepend=0.0), readings, strict=True
    ):
        ekf.predict(rolled_m, duration_s)
        ekf.correct(ranges_m)
        poses.append(ekf.state[:3].copy())
        covariances.append(ekf.covariance[:3, :3])
    return Estimate(np.arange(len(knowledge)), np.array(poses), np.array(covariances))


METHOD = Method("ekf", "EKF", "odometry, corrected by ToF readings that agree with the map", _estimate)

"""Extended Kalman filter: odometry, corrected by ToF readings that agree with the map (Thrun, Burgard and Fox,
Probabilistic Robotics, 2005, sections 3.3 and 7.4).

Beside pose and wheels the state has two numbers for each ToF sensor: a gain of its error that never changes, and an
offset that lasts while the sensor looks at one wall from one side, as a first-order Gauss-Markov process. If the filter
took these errors for new noise in every reading, it would become overconfident in a wrong pose.
"""

from collections.abc import Sequence
from math import exp

import numpy as np

from pipeline.baselines.base import Method, TrainingRun
from pipeline.baselines.motion import STATES, WheelMotion, initial_state, rolled_distances_m
from pipeline.baselines.range_model import GAIN_SD, LASTING_SD_M, RangeModel, white_sd_m
from pipeline.baselines.robot_knowledge import RobotKnowledge
from sensors.ranging.tof import log_error_m
from symolo.core.arrays import Array
from symolo.evaluation.estimate import Estimate

RAYS = 30
GAIN, OFFSET = STATES, STATES + 3
"""Index of the first gain and of the first offset of the three sensors in the state."""
ALL = STATES + 6
LASTING_S = 1.0
"""Correlation time [s] of the offset of a sensor, which changes with the wall and the side from which it is seen."""
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
    def __init__(self, knowledge: RobotKnowledge, further_sd: Array | None = None) -> None:
        """Begin at the start, with further states (K,) of these standard deviations, which do not change by moving."""
        self._motion = WheelMotion.of(knowledge)
        self._ranges = RangeModel(knowledge, RAYS)
        state, covariance = initial_state(knowledge.start)
        more = np.zeros(0) if further_sd is None else further_sd
        self.state = np.concatenate([state, np.zeros(6 + len(more))])
        self.covariance = np.diag([0.0] * STATES + [GAIN_SD**2] * 3 + [LASTING_SD_M**2] * 3 + (more**2).tolist())
        self.covariance[:STATES, :STATES] = covariance
        self._speed = np.zeros(3)

    def predict(self, rolled_m: Array, duration_s: float) -> None:
        remaining = exp(-duration_s / LASTING_S)
        by_state, by_rolled = np.eye(len(self.state)), np.zeros((len(self.state), 2))
        by_state[OFFSET:ALL, OFFSET:ALL] *= remaining
        by_state[:STATES, :STATES], by_rolled[:STATES] = self._motion.jacobians(self.state[:STATES], rolled_m)
        noise = (by_rolled * self._motion.slip_sd_m(rolled_m) ** 2) @ by_rolled.T
        noise[OFFSET:ALL, OFFSET:ALL] += (1.0 - remaining**2) * LASTING_SD_M**2 * np.eye(3)
        self.covariance = by_state @ self.covariance @ by_state.T + noise
        moved = self._motion.moved(self.state[:STATES], rolled_m)
        if duration_s > 0.0:
            self._speed = (moved - self.state[:STATES])[:3] / duration_s
        self.state[:STATES] = moved
        self.state[OFFSET:ALL] *= remaining

    def correct(self, ranges_m: Array) -> None:
        """Update the state by readings (3,) [m], nan where there is none."""
        if np.isnan(ranges_m).all():
            return
        at = self.state[:3].copy()
        expected_m, slopes, bend_m = self._expected(at)
        for sensor in np.flatnonzero(~np.isnan(ranges_m + expected_m)).tolist():
            mean_m, slope = float(expected_m[sensor]), slopes[sensor]
            gain, offset = self.state[GAIN + sensor], self.state[OFFSET + sensor]
            error_m = float(log_error_m(expected_m[sensor]))
            row = np.zeros(len(self.state))
            row[:3], row[GAIN + sensor], row[OFFSET + sensor] = slope, error_m, 1.0
            late_m = slope @ self._speed * self._ranges.age_sd_s
            variance = float(white_sd_m(mean_m) ** 2 + late_m**2 + bend_m[sensor] ** 2)
            innovation = float(ranges_m[sensor] - mean_m - gain * error_m - offset - slope @ (self.state[:3] - at))
            if innovation**2 <= GATE * float(row @ self.covariance @ row + variance):
                self.state, self.covariance = updated(self.state, self.covariance, row, innovation, variance)

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

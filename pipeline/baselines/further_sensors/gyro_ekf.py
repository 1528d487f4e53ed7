"""The EKF with a gyroscope: its turn corrects that of the wheels from row to row.

The state also has bias, growth of the bias with the temperature, and relative error of the scale of the gyroscope. Its
reading is the difference between the headings of two rows, so the heading at the row before is a state too (stochastic
cloning: Roumeliotis and Burdick, "Stochastic cloning", ICRA 2002). While the robot stands, the wheels show that it does
not turn, and the filter measures the bias.
"""

import numpy as np

from pipeline.baselines.ekf import GATE, KalmanFilter, updated
from pipeline.baselines.further_sensors.imu_log import ImuLog
from pipeline.baselines.further_sensors.sensor_method import sensor_method
from pipeline.baselines.motion import STATES, rolled_distances_m
from pipeline.baselines.robot_knowledge import RobotKnowledge
from symolo.core.arrays import Array
from symolo.evaluation.estimate import Estimate

YAW = 2
YAW_BEFORE, BIAS, PER_K, SCALE = range(STATES, STATES + 4)
"""Indices in the state of the heading at the row before, and of the errors of the gyroscope."""


class GyroFilter(KalmanFilter):
    """The Kalman filter of wheels and ranges with the turns of a gyroscope.

    Its further states are the heading at the row before [rad], and of the gyroscope the bias [rad/s], the growth of the
    bias with the temperature [rad/(s K)] and the relative error of the scale.
    """

    def __init__(self, knowledge: RobotKnowledge, imu: ImuLog) -> None:
        errors = imu.errors
        super().__init__(knowledge, np.array([0.0, errors.bias_sd, errors.bias_per_K_sd, errors.scale_sd]))
        self._noise, self._walk = imu.noise_rad2_s, imu.walk_rad2_s3

    def predict(self, rolled_m: Array, duration_s: float) -> None:
        clone = np.eye(len(self.state))
        clone[YAW_BEFORE] = clone[YAW]
        self.state, self.covariance = clone @ self.state, clone @ self.covariance @ clone.T
        super().predict(rolled_m, duration_s)
        self.covariance[BIAS, BIAS] += self._walk * duration_s

    def turn(self, turn_rad: float, warmth_K_s: float, duration_s: float) -> None:
        """Update the state by the turn that the gyroscope read since the row before.

        Args:
            turn_rad: Sum of the readings times their periods.
            warmth_K_s: Integral of the temperature above that of the calibration.
            duration_s: Time since the row before.
        """
        turned_rad, scale = self.state[YAW] - self.state[YAW_BEFORE], 1.0 + self.state[SCALE]
        row = np.zeros(len(self.state))
        row[[YAW, YAW_BEFORE, BIAS, PER_K, SCALE]] = scale, -scale, duration_s, warmth_K_s, turned_rad
        expected_rad = scale * turned_rad + self.state[BIAS] * duration_s + self.state[PER_K] * warmth_K_s
        innovation_rad, variance = turn_rad - expected_rad, self._noise * duration_s
        if innovation_rad**2 > GATE * float(row @ self.covariance @ row + variance):
            # A wheel slipped, or a count was lost or late: the turn is that of the gyroscope, and says hardly anything
            # about the errors of the gyroscope.
            self.covariance[YAW, YAW] += innovation_rad**2
        self.state, self.covariance = updated(self.state, self.covariance, row, innovation_rad, variance)


def _estimate(knowledge: RobotKnowledge, imu: ImuLog) -> Estimate:
    ekf = GyroFilter(knowledge, imu)
    poses, covariances = [], []
    readings = np.where(knowledge.fresh, knowledge.ranges_m, np.nan)
    durations_s = np.diff(knowledge.t_s, prepend=knowledge.t_s[0])
    turns_rad, warmths_K_s = imu.between(knowledge.t_s)
    rows = zip(rolled_distances_m(knowledge), durations_s, turns_rad, warmths_K_s, readings, strict=True)
    for rolled_m, duration_s, turn_rad, warmth_K_s, ranges_m in rows:
        ekf.predict(rolled_m, duration_s)
        if duration_s > 0.0:
            ekf.turn(turn_rad, warmth_K_s, duration_s)
        ekf.correct(ranges_m)
        poses.append(ekf.state[:3].copy())
        covariances.append(ekf.covariance[:3, :3])
    return Estimate(np.arange(len(knowledge)), np.array(poses), np.array(covariances))


METHOD = sensor_method(
    "ekf_imu",
    "EKF with IMU",
    "as ekf, with the turns that the gyroscope reads less its bias",
    log_of=lambda further: further.imu,
    missing="the robot has no IMU: add one to robot.sensors",
    estimate=_estimate,
)

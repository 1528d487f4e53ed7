"""The gyroscope in the Kalman filter: what it learns while the robot stands, and whether the filter knows its error."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from pipeline.baselines.further_sensors.gyro_ekf import BIAS, METHOD, GyroFilter
from pipeline.baselines.further_sensors.imu_log import ImuLog
from pipeline.baselines.further_sensors.readings import FurtherReadings
from pipeline.baselines.motion import SHARES_SD, WheelMotion
from pipeline.baselines.robot_knowledge import SLIP_M_SQRT_M, Start
from sensors.inertial.imu import Accelerometer, Gyroscope, ImuSettings
from sensors.inertial.inertial_errors import ErrorSizes
from sensors.wheels.odometry import Odometry
from symolo.evaluation.errors import nees

NOISE, BIAS_SD = 3e-4, 0.005
PERIOD_S, ROW_S = 0.01, 0.05
STEP_RAD_S = 1e-9
"""So fine that rounding does not matter."""
ONLY_NOISE = ErrorSizes(NOISE, 0.0, 0.0, BIAS_SD, 0.0, 0.0, 0.0, 10.0)
NO_RNG = np.random.Generator(np.random.PCG64(0))
SURE = Start(np.zeros(3), np.full(3, 1e-4))


def log_of(yaw_rate_rad_s, errors=ONLY_NOISE):
    t_s = PERIOD_S * np.arange(len(yaw_rate_rad_s))
    return ImuLog(t_s, np.asarray(yaw_rate_rad_s), np.zeros(len(t_s)), errors, STEP_RAD_S)


def test_while_the_robot_stands_the_bias_becomes_known_as_the_mean_of_white_noise(before_a_wall):
    """The mean over T of a white noise N has the variance N^2 / T."""
    standing = before_a_wall(np.zeros((2, 2)), np.full(2, np.nan), SURE)
    gyro_filter, rows = GyroFilter(standing, log_of(np.zeros(2))), 200
    for _ in range(rows):
        gyro_filter.predict(np.zeros(2), ROW_S)
        gyro_filter.turn(0.004 * ROW_S, 0.0, ROW_S)
    information = 1.0 / BIAS_SD**2, rows * ROW_S / NOISE**2
    assert gyro_filter.covariance[BIAS, BIAS] == pytest.approx(1.0 / sum(information), rel=1e-6)
    assert gyro_filter.state[BIAS] == pytest.approx(0.004 * information[1] / sum(information), rel=1e-6)


def test_a_gyroscope_without_errors_is_as_exact_as_its_rounding(before_a_wall):
    """The rounding to steps of q has the variance q^2 / 12 (Bennett, 1948), here over a second of 100 samples."""
    perfect = before_a_wall(np.zeros((2, 2)), np.full(2, np.nan), SURE)
    nothing = {name: 0.0 for name in Gyroscope.model_fields if name != "range_rad_s"}
    settings = ImuSettings(gyroscope=Gyroscope(**nothing, range_rad_s=4.0), bits=13, period_s=PERIOD_S)
    imu = ImuLog.from_table(settings, np.column_stack((np.arange(0.0, 100.0, 10.0), np.zeros((10, 7)))))
    assert imu.noise_rad2_s == pytest.approx(100 * PERIOD_S**2 * (8.0 / 2**13) ** 2 / 12)
    gyro_filter = GyroFilter(perfect, imu)
    for _ in range(5):
        gyro_filter.predict(np.zeros(2), ROW_S)
        gyro_filter.turn(0.0, 0.0, ROW_S)
    assert gyro_filter.state[:3] == pytest.approx(np.zeros(3), abs=1e-12)


def test_the_turns_are_about_the_vertical_axis_of_the_robot_however_the_imu_is_mounted():
    """An IMU upside down whose x axis points upwards by 30 degrees; the robot turns by 0.2 rad/s for 0.1 s."""
    settings = ImuSettings(roll_deg=180, pitch_up_deg=30, calibrated_at_C=20)
    rate_S = 0.2 * np.array([np.sin(np.radians(30)), 0.0, -np.cos(np.radians(30))])
    table = [[t_ms, 0.0, 0.0, 9.81, *rate_S, 22.5] for t_ms in range(0, 150, 5)]
    turns_rad, warmth_K_s = ImuLog.from_table(settings, np.array(table)).between(np.array([0.0, 0.05, 0.1]))
    assert turns_rad == pytest.approx([0.0, 0.01, 0.01])
    assert warmth_K_s == pytest.approx([0.0, 0.125, 0.125])


def test_the_random_walk_for_the_bias_instability_has_its_allan_deviation():
    """K sqrt(tau / 3) is 0.664 B at 100 s (IEEE Std 952)."""
    log = ImuLog.from_table(ImuSettings(gyroscope=Gyroscope(bias_instability_rad_s=1e-3)), np.zeros((1, 8)))
    own = Gyroscope().random_walk_rad_s2_rtHz
    assert np.sqrt((log.walk_rad2_s3 - own**2) * 100.0 / 3.0) == pytest.approx(0.664e-3, rel=1e-3)
    assert Accelerometer().sizes() != log.errors


def test_in_a_world_as_it_takes_it_for_its_covariance_is_honest(before_a_wall):
    """NEES of the last pose over independent robots that drive a bend without any target in reach."""
    motion, rows, rolled_m = WheelMotion(Odometry(1.0, 0.14)), 40, np.array([0.011, 0.009])
    start_sd, count, total = np.array([0.003, 0.003, 0.01]), 40, 0.0
    for seed in range(count):
        rng = np.random.Generator(np.random.PCG64(seed))
        truth = np.concatenate([np.zeros(3), SHARES_SD * rng.standard_normal(3)])
        bias, poses = BIAS_SD * rng.standard_normal(), [truth[:3]]
        for _ in range(1, rows):
            slip = SLIP_M_SQRT_M * np.sqrt(rolled_m) * rng.standard_normal(2)
            truth = motion.moved(truth, rolled_m + slip)
            poses.append(truth[:3])
        samples_per_row = round(ROW_S / PERIOD_S)
        rates = np.repeat(np.diff([pose[2] for pose in poses]) / ROW_S, samples_per_row) + bias
        rates += NOISE / np.sqrt(PERIOD_S) * rng.standard_normal(len(rates))
        start = Start(poses[0] + start_sd * rng.standard_normal(3), start_sd)
        wheels = np.vstack((np.zeros(2), np.tile(rolled_m, (rows - 1, 1))))
        knowledge = before_a_wall(wheels, np.full(rows, np.nan), start)
        imu = log_of(np.concatenate(([0.0], rates)))
        estimate = METHOD.estimate(replace(knowledge, further=FurtherReadings(imu=imu)), (), NO_RNG)
        total += nees(estimate, np.array(poses))[-1]
    low, high = chi2.ppf([0.001, 0.999], 3 * count)
    assert low < total < high


def test_counts_that_come_a_row_late_leave_heading_and_bias_to_the_gyroscope(before_a_wall):
    """A robot of 0.14 m track turns by 0.1 rad a row; in every tenth row the encoders repeat the count before.

    The arc has the radius of the distance over the turn. A row that is late shifts a chord by one turn of the row.
    """
    turn_rad, forward_m, rows = 0.1, 0.01, 100
    step_m = forward_m + 0.5 * 0.14 * turn_rad * np.array([1.0, -1.0])
    wheels = np.tile(step_m, (rows, 1))
    wheels[5::10], wheels[6::10] = 0.0, 2.0 * step_m
    gyro_filter = GyroFilter(before_a_wall(wheels, np.full(rows, np.nan), SURE), log_of(np.zeros(2)))
    for rolled_m in wheels:
        gyro_filter.predict(rolled_m, ROW_S)
        gyro_filter.turn(turn_rad, 0.0, ROW_S)
    radius_m, yaw_rad = forward_m / turn_rad, rows * turn_rad
    assert gyro_filter.state[2] == pytest.approx(yaw_rad, abs=0.01)
    assert abs(gyro_filter.state[BIAS]) < BIAS_SD
    there_m = radius_m * np.array([np.sin(yaw_rad), 1.0 - np.cos(yaw_rad)])
    assert np.linalg.norm(gyro_filter.state[:2] - there_m) < rows // 10 * forward_m * turn_rad

"""The Kalman filter against least squares and, where all is linear, a Kalman filter; and whether it knows its error."""

import numpy as np
import pytest
from scipy.stats import chi2

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.baselines.ekf import METHOD, KalmanFilter, updated
from pipeline.baselines.motion import SHARES_SD, WheelMotion, rolled_distances_m
from pipeline.baselines.range_model import LASTING_SD_M, MOUNT_SD_RAD, OFFSET_SD_M
from pipeline.baselines.robot_knowledge import SLIP_M_SQRT_M, Start
from pipeline.baselines.runs import LoggedRun
from pipeline.stages.simulate import simulate
from sensors.wheels.odometry import Odometry
from symolo.evaluation.errors import nees

ROWS, WAY_M = 15, 0.004
SENSOR_TO_WALL_M = 0.415
"""At x = 0; all readings are below 0.18 m, where Eq. 24 has no error and Eq. 23 one deviation."""
NOISE_M = 0.00141
BEGIN_X_M = 0.26
OFFSET_OF_BOTH_SD_M = np.hypot(OFFSET_SD_M, LASTING_SD_M)
"""Of the sensor and of the one wall that it sees, which no reading distinguishes."""
NO_RNG = np.random.Generator(np.random.PCG64(0))


def test_updates_one_by_one_are_min_squares_with_the_prior():
    rng = np.random.Generator(np.random.PCG64(2))
    root = rng.normal(size=(4, 4))
    prior, covariance = rng.normal(size=4), root @ root.T
    rows, readings, variances = rng.normal(size=(6, 4)), rng.normal(size=6), rng.uniform(0.1, 2.0, 6)
    state, after = prior, covariance
    for row, reading, variance in zip(rows, readings, variances, strict=True):
        state, after = updated(state, after, row, float(reading - row @ state), float(variance))
    information = np.linalg.inv(covariance) + (rows.T / variances) @ rows
    expected = np.linalg.solve(information, np.linalg.inv(covariance) @ prior + (rows.T / variances) @ readings)
    assert state == pytest.approx(expected)
    assert after == pytest.approx(np.linalg.inv(information))


def kalman(readings_m, start_sd_m):
    """By x [m], share of the wheels' radius and the offset [m]; before a wall across the way all is linear."""
    state, covariance = np.array([BEGIN_X_M, 0.0, 0.0]), np.diag([start_sd_m, SHARES_SD[0], OFFSET_OF_BOTH_SD_M]) ** 2
    estimates = []
    for number, reading_m in enumerate(readings_m):
        if number:
            step = np.array([[1.0, WAY_M, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
            slip = 0.5 * SLIP_M_SQRT_M**2 * WAY_M  # of the mean of two wheels
            state = np.array([state[0] + WAY_M * (1 + state[1]), state[1], state[2]])
            covariance = step @ covariance @ step.T + np.diag([slip, 0.0, 0.0])
        row = np.array([-1.0, 0.0, 1.0])
        gain = covariance @ row / (row @ covariance @ row + NOISE_M**2)
        state = state + gain * (reading_m - SENSOR_TO_WALL_M - row @ state)
        covariance = (np.eye(3) - np.outer(gain, row)) @ covariance
        estimates.append((state[0], covariance[0, 0]))
    return np.array(estimates)


def test_where_all_is_linear_it_is_the_kalman_filter(before_a_wall):
    true_x_m = BEGIN_X_M + 0.004 + WAY_M * np.arange(ROWS)
    readings_m = SENSOR_TO_WALL_M - true_x_m + 0.001 * np.cos(1.7 * np.arange(ROWS))
    start_sd_m = 0.005
    start = Start(np.array([BEGIN_X_M, 0.0, 0.0]), np.array([start_sd_m, 1e-6, 1e-6]))
    given = before_a_wall(np.full((ROWS, 2), WAY_M), readings_m, start)
    estimate = METHOD.estimate(given, (), NO_RNG)
    expected = kalman(readings_m, start_sd_m)
    assert estimate.pose[:, 0] == pytest.approx(expected[:, 0], abs=2e-5)
    assert estimate.covariance[:, 0, 0] == pytest.approx(expected[:, 1], rel=5e-3)
    assert estimate.pose[-1, 0] == pytest.approx(true_x_m[-1], abs=0.004)


def test_in_a_world_as_it_takes_it_for_its_covariance_is_honest(before_a_wall):
    """NEES of the last pose over independent robots, within the bounds of chi-square."""
    motion, count, start_sd = WheelMotion(Odometry(1.0, 0.14)), 60, np.array([0.004, 0.004, 0.02])
    total = 0.0
    for seed in range(count):
        rng = np.random.Generator(np.random.PCG64(seed))
        truth = np.concatenate([[BEGIN_X_M, 0.0, 0.0], SHARES_SD * rng.standard_normal(3)])
        offset_m, poses, readings = OFFSET_OF_BOTH_SD_M * rng.standard_normal(), [], []
        for number in range(ROWS):
            if number:
                slip = SLIP_M_SQRT_M * np.sqrt(WAY_M) * rng.standard_normal(2)
                truth = motion.moved(truth, WAY_M + slip)
            poses.append(truth[:3])
            # The range along x of a sensor before the axle, turned a little.
            true_m = (0.5 - truth[0]) / np.cos(truth[2]) - 0.085
            readings.append(true_m + offset_m + NOISE_M * rng.standard_normal())
        start = Start(poses[0] + start_sd * rng.standard_normal(3), start_sd)
        estimate = METHOD.estimate(before_a_wall(np.full((ROWS, 2), WAY_M), np.array(readings), start), (), NO_RNG)
        total += nees(estimate, np.array(poses))[-1]
    low, high = chi2.ppf([0.001, 0.999], 3 * count)
    assert low < total < high


def test_a_reading_of_something_on_no_map_is_left_aside(before_a_wall):
    """Somebody's foot before the sensor, for one row in three."""
    x_m = BEGIN_X_M + WAY_M * np.arange(ROWS)
    readings_m = SENSOR_TO_WALL_M - x_m
    disturbed = np.where(np.arange(ROWS) % 3 == 1, 0.05, readings_m)
    start = Start(np.array([BEGIN_X_M, 0.0, 0.0]), np.array([0.003, 0.003, 0.01]))
    given = before_a_wall(np.full((ROWS, 2), WAY_M), disturbed, start)
    assert METHOD.estimate(given, (), NO_RNG).pose[:, 0] == pytest.approx(x_m, abs=0.001)


@pytest.mark.parametrize("turn_rad", [-0.01745, 0.01745])
def test_a_sensor_that_is_turned_in_its_mount_is_found(turn_rad):
    """The front sensor of the simulator is turned by a degree, which is one of the assumed standard deviations."""
    turned = f"robot.effects.tof_mount_yaw={{sensor: front, angle_rad: {turn_rad}}}"
    spec = draw_run(load_scenario("symolo", [turned, "stop={lap: false, time_limit_s: 12}"]), "CCW", 1)
    run = LoggedRun.of_recording(spec.key, spec, simulate(spec).recording)
    given = run.knowledge(np.array([0.001, 0.001, 0.002]), np.random.Generator(np.random.PCG64(0)))
    ekf = KalmanFilter(given)
    for step in zip(rolled_distances_m(given), np.diff(given.t_s, prepend=0.0), given.ranges_m, strict=True):
        ekf.predict(*step[:2])
        ekf.correct(step[2])
    front = -len(given.map.boxes) - 4  # before the turns of two more sensors, the floor and the boxes
    sd = np.sqrt(ekf.covariance[front, front])
    assert sd < 0.4 * MOUNT_SD_RAD
    assert abs(ekf.state[front] - turn_rad) < 3.0 * sd
    assert ekf.state[front] * turn_rad > 0.0

"""Poses smoothed beside the path of the wheels: corners stay sharp, and wrong poses do not count."""

import numpy as np
import pytest

from diagnosis.predictors.pose.guided_pose import GuidedPoses
from diagnosis.predictors.pose.pose_noise import PoseNoise

ROW_S, ROWS = 0.05, 120
TIMES = ROW_S * np.arange(ROWS)
LOGGED = np.ones(ROWS, dtype=bool)
NOISE = PoseNoise(0.002, 0.005, 0.0)


@pytest.fixture(scope="module")
def drive():
    """A robot at 0.3 m/s that begins and ends turns of 4 rad/s within a row: its poses and the steps of its wheels."""
    turn = np.where((np.arange(ROWS) // 15) % 2 == 1, 4.0, 0.0) * ROW_S
    forward = np.full(ROWS, 0.3 * ROW_S)
    turn[0] = forward[0] = 0.0
    yaw = 0.4 + np.cumsum(turn)
    middle = yaw - 0.5 * turn
    steps = np.stack([forward * np.cos(middle), forward * np.sin(middle)], axis=-1)
    pose = np.concatenate([np.array([1.0, 2.0]) + np.cumsum(steps, axis=0), yaw[:, None]], axis=-1)
    return pose, np.stack([forward, turn], axis=-1)


def test_a_sharp_turn_is_followed_though_the_wheels_drift(drive):
    """Wheels that count 3 % too much leave 3 % of a corner to the parabola, which alone would cut it by 40 mrad."""
    pose, steps = drive
    guided = GuidedPoses(pose, LOGGED, TIMES, [ROWS], 1.03 * steps, NOISE).at(0.0)
    alone = GuidedPoses(pose, LOGGED, TIMES, [ROWS], np.zeros((ROWS, 2)), NOISE).at(0.0)
    assert np.abs(alone - pose)[:, 2].max() > 0.03
    assert np.abs(guided - pose)[:, 2].max() < 0.003
    assert np.abs(guided - pose)[:, :2].max() < 0.001


def test_wrong_poses_do_not_count_and_their_rows_are_known(drive):
    pose, steps = drive
    noisy = pose + np.array([0.002, 0.002, 0.005]) * np.random.default_rng(1).standard_normal(pose.shape)
    wrong = [20, 21, 22, 57, 90]
    noisy[wrong] += [0.2, -0.1, 0.5]
    poses = GuidedPoses(noisy, LOGGED, TIMES, [ROWS], steps, NOISE)
    assert set(wrong) <= set(np.flatnonzero(~poses.is_right).tolist())
    assert np.count_nonzero(~poses.is_right) <= len(wrong) + 2
    assert np.abs(poses.at(0.0) - pose)[:, :2].max() < 0.008


def test_no_delay_has_less_noise_than_another(drive):
    """Half-way between two rows, interpolated poses would have 0.71 of the noise of a row, and seem to fit better."""
    pose, steps = drive
    rng = np.random.default_rng(2)
    errors = []
    for delay_s in (0.0, 0.025):
        later = np.interp(TIMES - delay_s, TIMES, pose[:, 0])
        off = [
            GuidedPoses(pose + 0.002 * rng.standard_normal(pose.shape), LOGGED, TIMES, [ROWS], steps, NOISE).at(
                delay_s
            )[:, 0]
            - later
            for _ in range(60)
        ]
        errors.append(float(np.std(np.array(off)[:, 10:-10])))
    assert errors[1] == pytest.approx(errors[0], rel=0.06)
    assert errors[0] < 0.7 * 0.002


def test_robots_with_several_delays_have_the_poses_of_each_delay_alone(drive):
    pose, steps = drive
    poses = GuidedPoses(pose, LOGGED, TIMES, [ROWS], steps, NOISE)
    delays_s = [0.03, 0.0, 0.03, 0.011]
    of_all = poses.at(np.array(delays_s)[:, None])
    np.testing.assert_array_equal(of_all, np.stack([poses.at(delay_s) for delay_s in delays_s]))

"""The path between rows against motions known in closed form."""

import numpy as np
import pytest

from symolo.core.geometry.robot_path import RobotPath

SPEED_M_S, RATE_RAD_S = 0.18, 1.5
ROWS_S = np.arange(21) * 0.05


def circle(t_s: np.ndarray) -> np.ndarray:
    """From the origin along +x, counter-clockwise."""
    yaw = RATE_RAD_S * t_s
    radius = SPEED_M_S / RATE_RAD_S
    return np.column_stack([radius * np.sin(yaw), radius * (1 - np.cos(yaw)), yaw])


@pytest.fixture
def path() -> RobotPath:
    pose = circle(ROWS_S)
    pose[:, 2] = (pose[:, 2] + 3.0 + np.pi) % (2 * np.pi) - np.pi - 3.0  # as data.csv wraps it, somewhere on the way
    return RobotPath(ROWS_S, pose, np.tile([SPEED_M_S, RATE_RAD_S], (len(ROWS_S), 1)))


def test_a_circle_is_kept_between_its_rows(path):
    times = np.linspace(0, 1, 333)
    poses = path.poses_at(times)
    # A cubic Hermite curve is off by the fourth derivative times h^4 / 384 at most.
    max_m = SPEED_M_S * RATE_RAD_S**3 * 0.05**4 / 384
    assert np.abs(poses[:, :2] - circle(times)[:, :2]).max() < 1.01 * max_m
    turned = poses[:, 2] - poses[0, 2]
    assert turned == pytest.approx(RATE_RAD_S * times, abs=1e-12)


def test_at_a_row_it_is_the_row(path):
    assert path.poses_at(ROWS_S)[:, :2] == pytest.approx(circle(ROWS_S)[:, :2], abs=1e-15)


def test_before_the_first_row_and_after_the_last_it_goes_straight_on(path):
    before, after = path.poses_at(np.array([-0.01, 1.01]))
    first, last = circle(np.array([0.0, 1.0]))
    for pose, row, seconds in ((before, first, -0.01), (after, last, 0.01)):
        ahead = SPEED_M_S * seconds * np.array([np.cos(row[2]), np.sin(row[2])])
        assert pose[:2] == pytest.approx(row[:2] + ahead, abs=1e-12)


def test_a_single_row_is_enough():
    alone = RobotPath(np.array([0.0]), np.array([[1.0, 2.0, 0.0]]), np.array([[0.1, 0.0]]))
    assert alone.poses_at(np.array([0.0, 0.1])) == pytest.approx(np.array([[1.0, 2.0, 0.0], [1.01, 2.0, 0.0]]))

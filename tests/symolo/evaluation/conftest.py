"""A path whose true poses are known by formula."""

import numpy as np
import pytest

from symolo.evaluation.estimate import EstimatedTrajectory


@pytest.fixture
def t_s():
    """Times of 401 rows, every 50 ms."""
    return np.arange(401) / 20


@pytest.fixture
def truth(t_s):
    """An ellipse with half axes of 1.5 m and 0.5 m, driven once in 20 s along its tangent."""
    phase = 2 * np.pi * t_s / 20
    yaw = np.arctan2(0.5 * np.cos(phase), -1.5 * np.sin(phase))
    return np.column_stack([2 + 1.5 * np.cos(phase), 0.5 * np.sin(phase), yaw])


@pytest.fixture
def at_rows(t_s):
    return lambda pose, covariance=None: EstimatedTrajectory(t_s, pose, covariance)


def turned(pose, yaw_rad, x_m, y_m):
    """Return poses after a turn about the origin and a shift."""
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    x, y, yaw = pose.T
    return np.column_stack([c * x - s * y + x_m, s * x + c * y + y_m, yaw + yaw_rad])


@pytest.fixture
def moved():
    return turned

"""The pre-computed path beside an obstacle, and a robot that follows it."""

import math

import numpy as np
import pytest

from physics.control.avoidance import PathFollower
from physics.control.paths import straight_path


@pytest.fixture(scope="module")
def config(robot):
    return robot.controller.avoidance


@pytest.mark.parametrize(("side", "sign"), [("left", 1.0), ("right", -1.0)])
def test_the_path_has_3200_even_points_out_along_and_back(config, side, sign):
    path = straight_path(config, side)
    assert path.points.shape == (3200, 2)
    steps = np.hypot(*np.diff(path.points, axis=0).T)
    assert steps == pytest.approx(path.spacing_m, rel=1e-3)
    assert path.points[0] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert path.points[-1] == pytest.approx([0.68, 0.0], abs=1e-9)
    beside = (path.points[:, 0] >= 0.26) & (path.points[:, 0] <= 0.42)
    assert path.points[beside, 1] == pytest.approx(sign * 0.19)
    assert path.points[path.back_begins, 0] == pytest.approx(0.42, abs=path.spacing_m)


def test_the_path_leaves_and_returns_in_the_direction_of_travel(config):
    points = straight_path(config, "left").points
    first, last = points[1] - points[0], points[-1] - points[-2]
    assert math.atan2(first[1], first[0]) == pytest.approx(0.0, abs=0.01)
    assert math.atan2(last[1], last[0]) == pytest.approx(0.0, abs=0.01)


def test_out_is_the_cubic_that_is_flat_at_both_ends(config):
    points = straight_path(config, "left").points
    u = points[points[:, 0] < 0.26, 0] / 0.26
    np.testing.assert_allclose(points[: len(u), 1], 0.19 * (3 * u**2 - 2 * u**3), atol=1e-6)


def ideal_drive(follower, start, *, beside_until_m=0.0, speed_m_s=0.14, tick_s=0.05):
    """Unicycle without lag; the obstacle is beside until the robot has come so far ahead in its own frame."""
    x, y, yaw = start
    travelled = []
    while not follower.finished and len(travelled) < 400:
        ahead = math.cos(start[2]) * (x - start[0]) + math.sin(start[2]) * (y - start[1])
        turn = follower.step((x, y, yaw), obstacle_beside=ahead < beside_until_m) * speed_m_s * tick_s
        x += speed_m_s * tick_s * math.cos(yaw + turn / 2)
        y += speed_m_s * tick_s * math.sin(yaw + turn / 2)
        yaw += turn
        travelled.append((x, y, yaw))
    return np.array(travelled)


def in_frame(travelled, start):
    c, s = math.cos(start[2]), math.sin(start[2])
    delta = travelled[:, :2] - np.array(start[:2])
    return delta @ np.array([[c, -s], [s, c]])


@pytest.mark.parametrize("start", [(0.0, 0.0, 0.0), (1.0, -2.0, 2.5)])
def test_an_ideal_robot_stays_on_the_path(config, start):
    path = straight_path(config, "left")
    local = in_frame(ideal_drive(PathFollower(path, start, config.look_ahead_m), start), start)
    distance = np.min(np.hypot(*(local[:, None] - path.points[None, ::10]).transpose(2, 0, 1)), axis=1)
    assert distance.max() < 0.012  # pure pursuit cuts corners by about look-ahead^2 / (8 R)
    assert local[-1] == pytest.approx([0.68, 0.0], abs=0.02)


def test_the_way_back_waits_until_the_obstacle_is_behind(config):
    path = straight_path(config, "left")
    start = (0.0, 0.0, 0.0)
    local = ideal_drive(PathFollower(path, start, config.look_ahead_m), start, beside_until_m=0.70)
    beside = local[(local[:, 0] > 0.30) & (local[:, 0] < 0.66)]
    assert beside[:, 1] == pytest.approx(0.19, abs=0.012)
    assert local[-1, 1] == pytest.approx(0.0, abs=0.02)
    assert local[-1, 0] > 0.90

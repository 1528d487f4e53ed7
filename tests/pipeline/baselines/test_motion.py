"""The motion of a robot that is not quite its drawing, against the board's odometry and closed forms."""

import numpy as np
import pytest

from pipeline.baselines.motion import WheelMotion
from sensors.wheels.odometry import Odometry

ODOMETRY = Odometry(1e-4, 0.14)
MOTION = WheelMotion(ODOMETRY)


def test_a_robot_as_drawn_moves_as_the_board_adds_up():
    counts = np.array([512, 301])
    moved = MOTION.moved(np.array([0.3, -0.2, 0.9, 0.0, 0.0, 0.0]), counts * ODOMETRY.metres_per_count)
    assert moved[:3] == pytest.approx(ODOMETRY.step((0.3, -0.2, 0.9), counts), abs=1e-15)


@pytest.mark.parametrize(
    ("shares", "turn_rad"),
    [((0.02, 0.0, 0.0), 0.0), ((0.0, 0.01, 0.0), 0.01 / 0.14), ((0.0, 0.01, 0.25), 0.01 / 0.14 / 1.25)],
)
def test_both_wheels_a_metre_turn_a_robot_by_the_difference_of_its_wheels(shares, turn_rad):
    moved = MOTION.moved(np.array([0.0, 0.0, 0.0, *shares]), np.array([1.0, 1.0]))
    assert moved[2] == pytest.approx(turn_rad, abs=1e-15)
    assert np.hypot(*moved[:2]) == pytest.approx(1.0 + shares[0])


def test_particles_move_as_each_for_itself():
    states = np.random.Generator(np.random.PCG64(1)).normal(size=(5, 6))
    ways = np.array([0.03, 0.02])
    assert np.allclose(MOTION.moved(states, ways), [MOTION.moved(state, ways) for state in states], rtol=0, atol=1e-15)


def test_jacobians_are_those_of_differences():
    state, ways = np.array([0.1, 0.2, 0.7, 0.01, -0.02, 0.03]), np.array([0.04, 0.025])
    by_state, by_ways = MOTION.jacobians(state, ways)
    step = 1e-6
    for column, move in zip(by_state.T, np.eye(6) * step, strict=True):
        change = (MOTION.moved(state + move, ways) - MOTION.moved(state - move, ways)) / (2 * step)
        assert column == pytest.approx(change, abs=1e-9)
    for column, move in zip(by_ways.T, np.eye(2) * step, strict=True):
        change = (MOTION.moved(state, ways + move) - MOTION.moved(state, ways - move)) / (2 * step)
        assert column == pytest.approx(change, abs=1e-9)


def test_random_slip_makes_way_and_heading_uncertain_with_the_root_of_the_distance():
    """After a straight way s: variances q^2 s / 2 along it, and 2 q^2 s / b^2 of the heading."""
    motion, covariance, state = WheelMotion(ODOMETRY, 1.6e-3), np.zeros((6, 6)), np.zeros(6)
    for _ in range(400):
        rolled_m = np.array([0.01, 0.01])
        by_state, by_rolled = motion.jacobians(state, rolled_m)
        covariance = by_state @ covariance @ by_state.T + (by_rolled * motion.slip_sd_m(rolled_m) ** 2) @ by_rolled.T
        state = motion.moved(state, rolled_m)
    assert covariance[0, 0] == pytest.approx(1.6e-3**2 * 4.0 / 2.0)
    assert covariance[2, 2] == pytest.approx(2.0 * 1.6e-3**2 * 4.0 / 0.14**2)

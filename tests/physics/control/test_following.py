"""The control law and its two errors, against the paper's equations worked by hand."""

import math

import pytest

from configs.schema.controller import FollowGains, WallFollowing
from physics.control.following import follow, line_error, wall_error

GAINS = FollowGains(k1_m_s=0.2, k2_rad_s=0.8, k3_m_s=0.02)
WALL = WallFollowing(
    gains=GAINS,
    target_distance_m=0.12,
    error_scale_per_m=30,
    far_error_limit=0.4,
    lost_beyond_m=0.34,
    found_within_m=0.34,
)


@pytest.mark.parametrize(
    ("on_line", "error"),
    [((3, 4), 0.0), ((4,), 0.5), ((3,), -0.5), ((7,), 3.5), ((0,), -3.5), ((5, 6, 7), 2.5), (range(8), 0.0)],
)
def test_the_line_error_is_the_mean_weight_of_the_active_channels(on_line, error):
    line = tuple(0.1 if channel in on_line else 0.9 for channel in range(8))
    assert line_error(line, 0.45) == pytest.approx(error)


def test_without_an_active_channel_there_is_no_line_error():
    assert line_error((0.9,) * 8, 0.45) is None


def test_the_wall_error_is_zero_at_the_target_distance():
    assert wall_error(0.12 / math.cos(math.radians(45)), WALL) == pytest.approx(0.0, abs=1e-12)


def test_the_wall_error_is_positive_too_close_and_saturates():
    # Eq. 13-14: 0.12 - 0.7071 * 0.10 = 0.0493 m, times 30 per metre.
    assert wall_error(0.10, WALL) == pytest.approx(30 * (0.12 - math.sqrt(0.5) * 0.10))
    assert wall_error(0.0, WALL.model_copy(update={"error_scale_per_m": 100})) == 3.5
    assert wall_error(2.0, WALL) == -0.4


def test_speed_falls_and_turn_grows_with_the_error():
    assert follow(0.0, GAINS) == (0.2, 0.0)
    v, w = follow(-2.5, GAINS)
    assert (v, w) == pytest.approx((0.2 - 0.02 * 2.5, -2.0))


def test_the_robot_never_backs_off_from_a_large_error():
    assert follow(3.5, FollowGains(k1_m_s=0.05, k2_rad_s=0.8, k3_m_s=0.1))[0] == 0.0

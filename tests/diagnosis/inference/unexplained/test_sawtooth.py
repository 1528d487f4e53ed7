"""An offset of the ranges that grows and is reset with a period."""

import numpy as np
import pytest

from diagnosis.inference.unexplained.drift.range_series import RangeSeries
from diagnosis.inference.unexplained.drift.sawtooth import squares_of_sawtooth

ROWS = 300
TIME_S = 2.0 * np.arange(ROWS)
SD_M = np.where(np.arange(ROWS) % 2 == 0, 0.002, 0.004)


def series(residual_m):
    return RangeSeries(TIME_S, np.zeros(ROWS, dtype=np.int64), residual_m, SD_M, np.zeros((0, ROWS)))


def noise_m(seed):
    return SD_M * np.random.default_rng(seed).standard_normal(ROWS)


def squares(residual_m):
    return float(((residual_m / SD_M) ** 2).sum())


@pytest.mark.parametrize(("period_s", "phase", "size_m"), [(37.3, 0.0, 0.012), (130.0, 0.8, -0.02), (211.0, 0.4, 0.03)])
def test_a_level_and_the_time_since_a_reset_take_all_but_the_noise(period_s, phase, size_m):
    noise = noise_m(1)
    left, _ = squares_of_sawtooth(series(0.004 + size_m * ((TIME_S / period_s + phase) % 1.0) + noise))
    assert left <= squares(noise) * 1.1


def test_without_noise_the_squares_are_those_of_a_linear_fit():
    """At the true period and reset a straight line through the time since the reset is exact."""
    left, _ = squares_of_sawtooth(series(0.01 * (TIME_S / (TIME_S[-1] / 5.0) % 1.0)))
    assert left == pytest.approx(0.0, abs=1e-6)


def test_of_white_noise_it_takes_little():
    """The largest of some ten thousand resets that differ takes about 2 ln 10,000 = 18 squares."""
    for seed in range(5):
        noise = noise_m(seed)
        left, periods = squares_of_sawtooth(series(noise))
        assert squares(noise) - left < 35.0
        assert periods == ROWS / 3.0 - 2.0


def test_one_ramp_does_not_repeat():
    residual_m = 0.012 * TIME_S / TIME_S[-1] * (TIME_S > 300.0)
    left, _ = squares_of_sawtooth(series(residual_m))
    assert left > 0.05 * squares(residual_m)


def test_readings_at_one_time_have_no_period():
    flat = RangeSeries(np.zeros(3), np.zeros(3, dtype=np.int64), np.ones(3), np.ones(3), np.zeros((0, 3)))
    assert squares_of_sawtooth(flat) == (3.0, 1.0)

"""An offset of the ranges that switches on and off with a period."""

import numpy as np
import pytest

from diagnosis.inference.unexplained.drift.range_series import RangeSeries
from diagnosis.inference.unexplained.drift.switching import squares_of_switching

ROWS = 300
TIME_S = 2.0 * np.arange(ROWS)
SD_M = np.where(np.arange(ROWS) % 2 == 0, 0.002, 0.004)


def series(residual_m):
    return RangeSeries(TIME_S, np.zeros(ROWS, dtype=np.int64), residual_m, SD_M, np.zeros((0, ROWS)))


def noise_m(seed):
    return SD_M * np.random.default_rng(seed).standard_normal(ROWS)


@pytest.mark.parametrize(("period_s", "duty", "phase"), [(37.3, 0.3, 0.0), (130.0, 0.55, 0.8), (211.0, 0.12, 0.4)])
def test_two_levels_take_all_but_the_noise(period_s, duty, phase):
    """A level while the offset is on, another one while it is off."""
    is_on = (TIME_S / period_s + phase) % 1.0 < duty
    noise = noise_m(1)
    squares, _ = squares_of_switching(series(np.where(is_on, 0.012, -0.003) + noise))
    # Rows within 1/128 of a period of an edge may count to the other side.
    assert squares <= float(((noise / SD_M) ** 2).sum()) * 1.1


def test_of_white_noise_it_takes_little():
    """The largest of some ten thousand windows that differ takes about 2 ln 10,000 = 18 squares."""
    for seed in range(5):
        noise = noise_m(seed)
        squares, periods = squares_of_switching(series(noise))
        assert float(((noise / SD_M) ** 2).sum()) - squares < 35.0
        assert periods == ROWS / 3.0 - 2.0


def test_a_jump_does_not_repeat():
    residual_m = np.where(np.arange(ROWS) > 140, 0.012, 0.0)
    squares, _ = squares_of_switching(series(residual_m))
    total = float(((residual_m / SD_M) ** 2).sum())
    assert squares > 0.2 * total


def test_readings_at_one_time_have_no_period():
    flat = RangeSeries(np.zeros(3), np.zeros(3, dtype=np.int64), np.ones(3), np.ones(3), np.zeros((0, 3)))
    assert squares_of_switching(flat) == (3.0, 1.0)

"""Counts that run on, wrap or start from zero in each row."""

import numpy as np
import pytest

from logs.counts import are_per_row, jump, running, unwrapped

T = 0.01 * np.arange(1500)
SPEED = 900.0 * np.sin(0.9 * T) + 400.0
"""Ticks per second, forwards and backwards."""
COUNTS = np.floor(1000.0 * (1.0 - np.cos(0.9 * T)) + 400.0 * T)


@pytest.mark.parametrize("bits", [10, 12, 16])
@pytest.mark.parametrize("begin", [0, 150, -700])
def test_a_counter_that_wraps_is_continued(bits, begin):
    for low in (0, -(2 ** (bits - 1))):
        wrapped = np.mod(COUNTS + begin - low, 2.0**bits) + low
        found, wraps_at = unwrapped(wrapped)
        np.testing.assert_array_equal(found - found[0], COUNTS - COUNTS[0])
        assert wraps_at == (2.0**bits if np.abs(np.diff(wrapped)).max() > 2.0 ** (bits - 1) else 0.0)


def test_missing_counts_stay_missing_when_a_counter_wraps():
    wrapped = np.mod(COUNTS, 4096.0)
    wrapped[::7] = np.nan
    found, _ = unwrapped(wrapped)
    known = np.isfinite(wrapped)
    assert (np.isfinite(found) == known).all()
    np.testing.assert_array_equal(found[known] - found[known][0], (COUNTS - COUNTS[known][0])[known])


def test_a_counter_that_wraps_elsewhere_is_continued_where_that_is_known():
    wrapped = np.mod(COUNTS, 1440.0)
    assert unwrapped(wrapped)[1] == 0.0
    assert abs(jump(wrapped, T)) > 1400.0
    found, wraps_at = unwrapped(wrapped, 1440.0)
    assert wraps_at == 1440.0
    np.testing.assert_array_equal(found - found[0], COUNTS - COUNTS[0])


def test_a_counter_that_is_set_to_zero_does_not_wrap():
    """The step to zero is no step of a wheel the other way round."""
    reset = COUNTS.copy()
    reset[900:] -= COUNTS[900]
    found, wraps_at = unwrapped(reset)
    assert wraps_at == 0.0
    np.testing.assert_array_equal(found, reset)
    assert jump(reset, T) == pytest.approx(COUNTS[899] - COUNTS[900] - COUNTS[899], abs=30)


def test_counts_that_run_on_have_no_jump():
    assert jump(COUNTS, T) == 0.0
    np.testing.assert_array_equal(unwrapped(COUNTS)[0], COUNTS)


def test_counts_that_run_on_during_a_gap_have_no_jump():
    logged = (T < 5.0) | (T > 8.0)
    assert jump(COUNTS[logged], T[logged]) == 0.0
    assert jump(np.where(T > 10.0, COUNTS - 40_000.0, COUNTS)[logged], T[logged]) < -30_000.0


def test_counts_of_single_rows_add_up_and_a_missing_one_is_bridged():
    per_row = np.diff(COUNTS, prepend=0.0)
    np.testing.assert_array_equal(running(per_row), COUNTS)
    gappy = per_row.copy()
    gappy[700] = np.nan
    found = running(gappy)
    assert np.isnan(found[700])
    np.testing.assert_allclose(found[701:], COUNTS[701:], atol=1.0)
    assert np.isnan(running(np.full(3, np.nan))).all()


@pytest.mark.parametrize("speed", [SPEED, 0.004 * SPEED + 0.3], ids=["ticks per second", "volts"])
def test_counts_of_single_rows_follow_the_speed_and_running_ones_do_not(speed):
    assert are_per_row(np.diff(COUNTS, prepend=0.0), speed)
    assert not are_per_row(COUNTS, speed)
    assert not are_per_row(np.mod(COUNTS, 4096.0), speed)


def test_counts_of_a_robot_that_starts_slowly_still_run_on():
    """Over a short run both the counts and the speed only grow."""
    speed = 30.0 * T[:400]
    assert not are_per_row(np.floor(15.0 * T[:400] ** 2), speed)

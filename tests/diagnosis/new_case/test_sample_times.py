"""Times at which rows were sampled, from stamps that scatter."""

import numpy as np
import pytest

from diagnosis.new_case.sample_times import are_even, even_times


@pytest.mark.parametrize("period_s", [0.004, 0.0125, 0.05])
def test_lost_rows_leave_a_gap_and_late_stamps_do_not(period_s):
    rng = np.random.Generator(np.random.PCG64(11))
    number = np.delete(np.arange(900), [*range(300, 301), *range(500, 540)])
    even_s = 3.0 + period_s * number
    stamps_s = even_s + np.abs(rng.normal(0.0, 0.15 * period_s, len(even_s)))
    stamps_s[[100, 700]] += 0.7 * period_s  # two rows that were stamped late
    times_s = even_times(stamps_s)
    np.testing.assert_array_equal(np.rint(np.diff(times_s) / period_s), np.diff(number))
    # All are late by the mean of |N(0, 0.15)|, 0.12 periods; the slope of 860 stamps is known to 1e-5.
    np.testing.assert_allclose(times_s, even_s + 0.12 * period_s, atol=0.03 * period_s)


def test_two_rows_keep_their_times():
    np.testing.assert_array_equal(even_times(np.array([0.5, 0.7])), [0.5, 0.7])


def stamped(seed):
    """Even times of 400 rows, and stamps that scatter around them by a fifth of a period."""
    even_s = 0.05 * np.arange(400)
    return even_s, even_s + 0.01 * np.random.default_rng(seed).standard_normal(400)


@pytest.mark.parametrize("factor", [1.0, 1e-3, 1e3])
def test_the_unit_of_a_column_does_not_decide(factor):
    """Of two columns, one moves evenly and one has only noise: this is so in metres and in millimetres."""
    even_s, stamps_s = stamped(3)
    noise = np.random.default_rng(4).standard_normal((2, 400))
    columns = [0.2 * even_s + 1e-4 * noise[0], factor * 1e-4 * noise[1]]
    assert are_even([stamps_s], [even_s], [columns])


def test_columns_that_move_evenly_against_the_stamps_keep_them():
    even_s, stamps_s = stamped(5)
    columns = [0.2 * stamps_s, 30.0 * stamps_s]
    assert not are_even([stamps_s], [even_s], [columns])
    assert not are_even([stamps_s], [even_s], [np.zeros((2, 400))])


@pytest.mark.filterwarnings("error")
def test_rows_with_one_stamp_divide_nothing_by_zero():
    """A controller that is busy for three rows writes them with one stamp."""
    even_s, stamps_s = stamped(6)
    stamps_s[100:102] = stamps_s[102]
    assert are_even([stamps_s], [even_s], [[0.2 * even_s]])


def test_a_wheel_at_rest_says_nothing_about_the_times():
    even_s, stamps_s = stamped(7)
    at_rest = np.full(400, 12345.1)
    assert are_even([stamps_s], [even_s], [[0.2 * even_s, at_rest]])
    assert not are_even([stamps_s], [even_s], [[0.2 * stamps_s, at_rest]])
    assert not are_even([stamps_s], [even_s], [[at_rest]])

"""Times at which rows were sampled, from stamps that scatter."""

import numpy as np
import pytest

from diagnosis.new_case.sample_times import even_times


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

"""Which estimate belongs to which row, how much of a run is covered, and suspicious times."""

import numpy as np
import pytest

from symolo import EstimatedTrajectory, InputError
from symolo.evaluation.association import associated
from symolo.evaluation.errors import coverage

ROWS_S = np.arange(0, 21) / 10


def estimates_at(t_s):
    t_s = np.asarray(t_s, float)
    return EstimatedTrajectory(t_s, np.column_stack([np.minimum(t_s, 1e6), 0 * t_s, 0 * t_s]))


def test_each_estimate_belongs_to_the_nearest_row_within_the_gap():
    estimate = associated(estimates_at([0.004, 0.093, 0.25, 0.312, 1.49, 1.7]), ROWS_S, 0.01)
    assert estimate.rows.tolist() == [0, 1, 15, 17]
    assert estimate.pose[:, 0].tolist() == [0.004, 0.093, 1.49, 1.7]


def test_the_largest_gap_is_allowed_itself_although_its_digits_are_binary():
    assert associated(estimates_at([0.01, 0.71, 1.39]), ROWS_S, 0.01).rows.tolist() == [0, 7, 14]


def test_of_several_estimates_at_a_row_the_nearest_is_taken():
    t_s = np.sort(np.concatenate([ROWS_S, ROWS_S + 0.004]))
    assert associated(estimates_at(t_s), ROWS_S, 0.01).pose[:, 0].tolist() == ROWS_S.tolist()


def test_coverage_is_the_share_of_seconds_with_an_estimate():
    rows_s = np.arange(0, 101) / 10
    assert coverage(rows_s, rows_s) == 1.0
    assert coverage(np.array([0.5, 0.7, 3.0, 9.99, 10.0]), rows_s) == pytest.approx(0.3)
    assert coverage(np.array([]), rows_s) == 0.0
    assert coverage(np.array([0.0]), np.array([0.0])) == 1.0
    assert coverage(np.array([10.2]), np.arange(0, 104) / 10) == pytest.approx(1 / 11)  # the last, of 0.3 s


@pytest.mark.parametrize(
    ("change", "messages"),
    [
        (lambda t: 1000 * t, ["are probably milliseconds", "multiply them by 0.001"]),
        (lambda t: 1e9 * t, ["are probably nanoseconds"]),
        (lambda t: t / 1000, ["are probably seconds, and were taken for milliseconds", "multiply them by 1000"]),
        (lambda t: t + 1.7e9, ["count from another moment than the first row", "subtract 1.7e+09 s"]),
        (lambda t: 1000 * t + 5e6, ["milliseconds", "another moment", "multiply them by 0.001 and subtract 5000 s"]),
        (lambda t: t + 30, ["subtract 30 s", "from 30 s to 32 s, and the run is from 0 s to 2 s"]),
        (lambda t: t[:3] + 0.03, ["no estimate is within 10 ms of a row"]),
    ],
)
def test_times_in_another_unit_or_from_another_moment_are_refused_with_the_cure(change, messages):
    with pytest.raises(InputError) as refused:
        associated(estimates_at(change(ROWS_S)), ROWS_S, 0.01)
    for message in messages:
        assert message in str(refused.value)


@pytest.mark.parametrize("rate_hz", [20, 50, 100])
def test_milliseconds_that_begin_with_a_long_run_are_refused_although_some_lie_within_it(rate_hz):
    """Of the times 0, 50, 100 ... of a run of a minute, taken for seconds, the first two are within it, and span it."""
    rows_s = np.arange(60 * rate_hz + 1) / rate_hz
    with pytest.raises(InputError, match="are probably milliseconds"):
        associated(estimates_at(1000 * rows_s), rows_s, 0.01)


def test_estimates_of_a_part_of_the_run_are_no_suspicion():
    rows_s = np.arange(0, 1201) / 20
    assert len(associated(estimates_at(rows_s[:30]), rows_s, 0.01).rows) == 30
    assert len(associated(estimates_at([30.0]), rows_s, 0.01).rows) == 1

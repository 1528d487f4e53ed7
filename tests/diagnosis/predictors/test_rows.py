"""Covariates from other rows than those of their residuals."""

import numpy as np

from diagnosis.predictors.rows import by_other_rows, step_by_other_rows

ROWS = 40
TRIAL = np.repeat([0, 1, 2, 3], [20, 15, 3, 2])


def test_a_value_that_changes_evenly_is_that_of_its_row():
    values = np.stack([3.0 * np.arange(ROWS), np.full(ROWS, 7.0)], axis=-1)
    smooth = by_other_rows(values, TRIAL)
    inside = np.r_[2:18, 22:33]
    np.testing.assert_allclose(smooth[inside], values[inside])


def test_a_value_does_not_depend_on_its_row_and_those_beside_it_nor_on_another_trial():
    """By the response to each row alone."""
    response = by_other_rows(np.eye(ROWS), TRIAL)
    row = np.arange(ROWS)
    apart = np.abs(row[:, None] - row)
    assert (response[:35][apart[:35] < 2] == 0.0).all()
    assert (response[TRIAL[:, None] != TRIAL] == 0.0).all()
    np.testing.assert_allclose(response.sum(axis=1), 1.0)


def test_at_the_ends_of_a_trial_one_side_counts_and_in_a_short_trial_the_row_itself():
    values = np.arange(ROWS) ** 2.0
    smooth = by_other_rows(values, TRIAL)
    assert smooth[0] == values[2]
    assert smooth[19] == values[17]
    assert smooth[36] == values[36]
    np.testing.assert_array_equal(smooth[38:], values[38:])


def test_a_change_does_not_depend_on_its_row_and_those_beside_it_nor_on_another_trial():
    response = step_by_other_rows(np.eye(ROWS), TRIAL)
    inside = np.r_[2:18, 22:33]
    assert np.isnan(np.delete(response, inside, axis=0)).all()
    expected = np.zeros((ROWS, ROWS))
    expected[inside, inside + 2], expected[inside, inside - 2] = 0.25, -0.25
    np.testing.assert_allclose(response[inside], expected[inside])

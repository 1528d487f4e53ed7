"""Rows left out of a made-up bench, against the closed form of linear least squares."""

import numpy as np
import pytest

from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.unexplained.leave_one_out import MAX_ROWS, leave_one_out

SD_A, TOLERANCE = 0.01, 0.02
X = np.linspace(0.5, 2.0, 8)
OFF = 0.01 * np.array([0.6, -0.9, 0.3, 1.1, -0.7, -0.2, 0.8, -1.0])


def test_a_row_left_out_is_missed_by_its_residual_over_one_less_its_leverage(evidence_of, hypothesis):
    """e / (1 - h), h = x^2 / sum of x^2, in which the prior of the one number counts as an observation more."""
    evidence = evidence_of(X, X + OFF)
    (fit,) = fits(evidence, [(hypothesis, hypothesis.null())])
    found = leave_one_out(evidence, fit)["current_A"]
    squares = X**2 / SD_A**2
    total = squares.sum() + 1.0 / TOLERANCE**2
    slope = ((X + OFF) * X / SD_A**2).sum() + 1.0 / TOLERANCE**2
    expected = (X + OFF - X * slope / total) / (1.0 - squares / total)
    np.testing.assert_allclose(found, expected, atol=0.03 * SD_A)


def test_a_wild_row_does_not_hide_when_it_is_left_out(evidence_of, hypothesis):
    evidence = evidence_of(X, X + np.where(np.arange(8) == 7, 0.5, 0.0))
    (fit,) = fits(evidence, [(hypothesis, hypothesis.null())])
    assert leave_one_out(evidence, fit)["current_A"][7] == pytest.approx(0.5, abs=1e-3)


def test_rows_that_are_not_usable_are_not_missed(evidence_of, hypothesis):
    evidence = evidence_of(X, np.where(np.arange(8) == 3, np.nan, X))
    (fit,) = fits(evidence, [(hypothesis, hypothesis.null())])
    np.testing.assert_array_equal(np.isnan(leave_one_out(evidence, fit)["current_A"]), np.arange(8) == 3)


def test_more_rows_than_it_is_for_are_refused(evidence_of, hypothesis):
    x = np.ones(MAX_ROWS + 1)
    evidence = evidence_of(x, x)
    (fit,) = fits(evidence, [(hypothesis, hypothesis.null())])
    with pytest.raises(ValueError, match="at most 60"):
        leave_one_out(evidence, fit)

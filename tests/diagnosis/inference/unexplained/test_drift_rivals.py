"""What explains the ranges of a drive as a random drift would, and which of their rows a drift explains."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from diagnosis.inference.unexplained.drift.gauss_markov import ErrorModel, predictable
from diagnosis.inference.unexplained.drift.range_series import RangeRows
from diagnosis.inference.unexplained.drift.rivals import gains_of_others
from diagnosis.inference.unexplained.drift.search import DriftSearch, regular
from diagnosis.predictors.base import Covariate

ROWS, ROW_S = 4800, 0.05
TIME_S = ROW_S * np.arange(ROWS)
HEADING_RAD = np.sin(0.2 * TIME_S)


def gain_along_the_heading(residual_m):
    """Fall of the cost by a function of the heading, in the ranges of one sensor with a white noise of 1 m."""
    one = np.zeros(ROWS, dtype=np.int64)
    covariates = (Covariate("theta_rad", HEADING_RAD),)
    ranges = RangeRows(np.arange(ROWS), one, one, "session_time_s", TIME_S, covariates)
    fit: Any = SimpleNamespace(z=residual_m, sd=np.ones(ROWS), slopes=np.zeros((0, ROWS)))
    every = np.ones(ROWS, dtype=bool)
    (gain,) = gains_of_others(fit, np.array([1.0]), ranges, TIME_S, every, is_bench=False)
    return gain


@pytest.mark.parametrize("seed", range(3))
def test_noise_that_neighbours_share_is_no_function_of_what_changes_slowly(seed):
    """Each reading has the mean of the noise of three rows, as poses have that are smoothed over them."""
    white = np.random.default_rng(seed).standard_normal(ROWS + 2)
    shared = np.convolve(white, np.ones(3) / np.sqrt(3.0), mode="valid")
    assert gain_along_the_heading(shared) < 6.0
    # Three rows are worth one: n a^2 / 3 / var, with the variance of a wave a^2 / 2.
    assert gain_along_the_heading(shared + 0.5 * np.sin(4.0 * HEADING_RAD)) > 100.0


def test_only_what_the_rows_before_do_not_suggest_is_no_part_of_a_drift():
    """A drift of 40 standard deviations of the noise, and one row that is 20 away from it."""
    rng, drift_m = np.random.default_rng(1), 0.4 * np.sin(0.01 * TIME_S)
    residual_m = drift_m + 0.01 * np.clip(rng.standard_normal(ROWS), -3.0, 3.0)
    residual_m[2000] = drift_m[2000] + 0.2
    near = predictable(TIME_S, residual_m, np.full(ROWS, 0.01), ErrorModel(100.0, 0.3, 1.0), 4.0)
    assert np.flatnonzero(~near).tolist() == [2000]


def test_near_a_wall_a_drift_takes_readings_far_from_their_noise():
    """The noise is 4 mm in a tenth of the rows and 80 mm in the others, and the drift has 40 mm."""
    rng, sd_m = np.random.default_rng(2), np.where(TIME_S % 40.0 < 4.0, 0.004, 0.08)
    residual_m = 0.04 * np.sin(0.3 * TIME_S) + sd_m * np.clip(rng.standard_normal(ROWS), -3.0, 3.0)
    outlier = int(np.flatnonzero(sd_m < 0.01)[300])
    residual_m[outlier] += 0.3
    one = np.zeros(ROWS, dtype=np.int64)
    ranges = RangeRows(np.arange(ROWS), one, one, "session_time_s", TIME_S, ())
    evidence: Any = SimpleNamespace(fit=np.ones(ROWS, dtype=bool), observed=[SimpleNamespace(is_series=True)])
    fit: Any = SimpleNamespace(z=residual_m / sd_m, sd=sd_m)
    rows = regular(fit.z, evidence.fit)
    assert np.count_nonzero(~rows & (sd_m < 0.01)) > 100
    seen: Any = SimpleNamespace(fit=fit, error=ErrorModel(3.0, 0.03, 1.0))
    kept = DriftSearch(evidence, ranges, TIME_S, rows, np.array([3.0]), ROW_S).with_drifted_rows(seen)
    assert np.flatnonzero(~kept.rows).tolist() == [outlier]

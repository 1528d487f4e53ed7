"""The likelihood of an offset that changes once, against least squares for each moment alone."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.inference.unexplained.drift.elsewhere import Elsewhere
from diagnosis.inference.unexplained.drift.gauss_markov import estimate
from diagnosis.inference.unexplained.drift.jump import JUMP_ROWS, best_jump
from diagnosis.inference.unexplained.drift.range_series import RangeSeries

COUNT = 40


@pytest.fixture
def series():
    """Rows of uneven noise whose distance grows with the time, so that a scale takes over a part of a jump."""
    rng = np.random.default_rng(3)
    t_s, sd_m = np.arange(COUNT, dtype=float), rng.uniform(0.001, 0.003, COUNT)
    distance_m = 0.2 + 0.02 * t_s
    residual_m = np.where(t_s >= 25.0, -0.02, 0.0) + 0.01 * distance_m + sd_m * rng.standard_normal(COUNT)
    return RangeSeries(t_s, np.zeros(COUNT, dtype=int), residual_m, sd_m, np.stack([0.005 * distance_m]))


def test_a_jump_has_the_cost_of_the_best_moment_with_all_numbers_moving_along(series):
    elsewhere = Elsewhere(np.array([[1.7]]), np.array([-0.4]), 0.9)
    costs = []
    for first in range(JUMP_ROWS, COUNT - JUMP_ROWS):
        slopes_m = np.stack([*series.slopes_m, np.ones(COUNT), (np.arange(COUNT) >= first).astype(float)])
        information, pull = np.zeros((3, 3)), np.zeros(3)
        information[0, 0], pull[0] = elsewhere.information[0, 0], elsewhere.pull[0]
        level = 1.0
        for _ in range(50):
            covariance = np.diag(level * series.sd_m**2)
            found = estimate(series.residual_m, slopes_m, covariance, information, pull)
            costs.append(np.linalg.slogdet(covariance)[1] + found.squares + elsewhere.squares_after(found.change[:1]))
            level *= found.squares / COUNT
    assert best_jump(series, elsewhere).cost == pytest.approx(min(costs), abs=0.01)


def test_a_jump_needs_rows_before_and_after_it(series):
    few = slice(2 * JUMP_ROWS)
    short = RangeSeries(
        series.at[few], series.path[few], series.residual_m[few], series.sd_m[few], series.slopes_m[:, few]
    )
    assert best_jump(short, Elsewhere(np.eye(1), np.zeros(1), 0.0)) is None


def test_a_jump_that_a_coordinate_of_the_fit_describes_already_is_none(series):
    """Rows of even noise, of which the coordinate moves the last ones: no jump is left, and one elsewhere is found."""
    after = (series.at >= 25.0).astype(float)
    known = replace(series, slopes_m=after[None], sd_m=np.full(COUNT, 0.002))
    jump = best_jump(known, Elsewhere(np.zeros((1, 1)), np.zeros(1), 0.0))
    assert np.isfinite(jump.cost)
    assert np.abs(jump.z).max() < 4.0


def test_rows_without_any_error_have_a_jump_of_nothing(series):
    still = replace(series, residual_m=np.zeros(COUNT))
    jump = best_jump(still, Elsewhere(np.eye(1), np.zeros(1), 0.0))
    assert np.isfinite(jump.cost)
    assert np.array_equal(jump.z, np.zeros(COUNT))

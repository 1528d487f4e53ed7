"""The likelihood of an offset that changes once, against least squares for each moment alone."""

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

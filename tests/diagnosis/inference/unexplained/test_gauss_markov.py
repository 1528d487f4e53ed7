"""The likelihood of a random drift, against the dense normal distribution of all rows."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from diagnosis.inference.unexplained.drift.gauss_markov import ErrorModel, estimate, likelihoods

T_S = np.cumsum(np.random.default_rng(1).uniform(0.5, 4.0, 40))
SD_M = np.random.default_rng(2).uniform(0.001, 0.004, 40)
RESIDUAL_M = 0.003 * np.random.default_rng(3).standard_normal(40)


@pytest.mark.parametrize(("tau", "ratio"), [(0, 0), (0, 1), (1, 0), (1, 1)])
def test_the_filter_has_the_likelihood_of_the_normal_distribution(tau, ratio):
    times_s, ratios = np.array([5.0, 60.0]), np.array([0.2, 4.0])
    found = likelihoods(T_S, RESIDUAL_M, SD_M, times_s, ratios)
    level = found.levels[tau, ratio]
    error = ErrorModel(times_s[tau], np.median(SD_M) * np.sqrt(level * ratios[ratio]), level)
    dense = multivariate_normal(cov=error.covariance(T_S, SD_M))
    # The quadratic form at the most probable level is the number of rows.
    constant = len(T_S) * (1.0 + np.log(2.0 * np.pi))
    assert found.costs[tau, ratio] + constant == pytest.approx(-2.0 * dense.logpdf(RESIDUAL_M), rel=1e-9)


def test_no_other_level_of_the_noise_is_more_probable():
    ratio = np.array([4.0])
    found = likelihoods(T_S, RESIDUAL_M, SD_M, np.array([60.0]), ratio)
    level = float(found.levels[0, 0])

    def density(factor):
        unit = ErrorModel(60.0, np.median(SD_M) * np.sqrt(factor * level * 4.0), factor * level)
        return multivariate_normal(cov=unit.covariance(T_S, SD_M)).logpdf(RESIDUAL_M)

    assert density(1.0) > max(density(0.95), density(1.05))


def test_an_offset_among_independent_rows_is_their_weighted_mean():
    weight = SD_M**-2.0
    found = estimate(RESIDUAL_M, np.ones((1, 40)), np.diag(SD_M**2), np.zeros((1, 1)), np.zeros(1))
    assert found.change[0] == pytest.approx((weight * RESIDUAL_M).sum() / weight.sum())
    assert found.covariance[0, 0] == pytest.approx(1.0 / weight.sum())


def test_an_offset_beside_an_error_that_hardly_changes_is_as_uncertain_as_the_error():
    slow = ErrorModel(tau_s=1e6, error_m=0.01, level=1.0)
    found = estimate(RESIDUAL_M, np.ones((1, 40)), slow.covariance(T_S, SD_M), np.zeros((1, 1)), np.zeros(1))
    assert np.sqrt(found.covariance[0, 0]) == pytest.approx(0.01, rel=0.01)

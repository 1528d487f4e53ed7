"""The density of good readings and outliers, and the noise that is fitted to it."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import quad

from diagnosis.inference.evidence.evidence import Prediction
from diagnosis.inference.fitting.likelihood import (
    LEVEL_SD,
    LEVELS,
    MEAN_SHARE,
    WIDTH,
    NoiseFit,
    costs_of_residuals,
    fitted_noise,
    sample_costs,
    stated_noise,
    weights,
)


def evidence_of(n, quantities=1, *, is_stated=True):
    """Observations of n samples with a noise of 1, in equal parts of each quantity."""
    return SimpleNamespace(
        values=np.zeros(n),
        sd=np.ones(n),
        weight=np.ones(n),
        fit=np.ones(n, dtype=bool),
        heldout=np.zeros(n, dtype=bool),
        observed=[SimpleNamespace(noise_is_stated=is_stated)] * quantities,
        quantity=np.repeat(np.arange(quantities), n // quantities),
    )


def cost_at(z, share=0.05, sd=1.0):
    z = np.atleast_1d(np.asarray(z, dtype=float))
    noise = NoiseFit(np.array([sd]), np.array([share]))
    return costs_of_residuals(evidence_of(len(z)), z, np.full(len(z), sd), noise)


@pytest.mark.parametrize("sd", [0.6, 1.0, 1.8])
def test_the_cost_is_that_of_a_density_whose_integral_is_one(sd):
    def density(error):
        return np.exp(-0.5 * cost_at(error / sd, sd=sd)[0]) / np.sqrt(2.0 * np.pi)

    near = quad(density, -100.0, 100.0, points=[-5.0, 5.0], limit=400)[0]
    # Beyond 100 sigmas there are outliers only: both tails of a Cauchy density.
    tails = 0.05 * 2.0 * (0.5 - np.arctan(100.0 / WIDTH) / np.pi)
    assert near + tails == pytest.approx(1.0, abs=1e-6)


def test_a_usable_sample_without_a_finite_prediction_costs_infinity_and_one_that_is_not_usable_nothing():
    evidence = evidence_of(6)
    evidence.values[2], evidence.fit[[2, 3]] = np.nan, False
    evidence.heldout[3] = True
    mean = np.array([[0.0, np.nan, np.nan, np.nan, np.inf, -np.inf]])
    costs = sample_costs(evidence, Prediction(mean, np.ones((1, 6)), np.zeros(1)), stated_noise(evidence))
    assert np.isfinite(costs[0, 0])
    np.testing.assert_array_equal(costs[0, 1:], [np.inf, 0.0, np.inf, np.inf, np.inf])
    costs = sample_costs(
        evidence, Prediction(np.zeros((1, 6)), np.full((1, 6), np.nan), np.zeros(1)), stated_noise(evidence)
    )
    np.testing.assert_array_equal(costs[0], [np.inf, np.inf, 0.0, np.inf, np.inf, np.inf])


def test_an_outlier_ten_times_as_far_costs_four_times_the_logarithm_of_ten_more():
    far = cost_at([1e4, 1e5])
    assert far[1] - far[0] == pytest.approx(4.0 * np.log(10.0), rel=1e-4)


def test_the_weight_is_half_the_slope_of_the_cost_over_z():
    z = np.array([0.3, 1.0, 2.8, 3.5, 20.0])
    slope = (cost_at(z + 1e-6, sd=1.3) - cost_at(z - 1e-6, sd=1.3)) / 2e-6
    noise = NoiseFit(np.array([1.3]), np.array([0.05]))
    weight, _ = weights(evidence_of(len(z)), z, np.full(len(z), 1.3), noise)
    np.testing.assert_allclose(weight, 0.5 * slope / z, rtol=1e-5)


def test_good_readings_are_good_and_wild_ones_are_outliers():
    z = np.array([0.0, 1.0, 2.0, 6.0, 30.0])
    _, is_good = weights(evidence_of(5), z, np.ones(5), stated_noise(evidence_of(5)))
    assert (is_good[:3] > 0.95).all()
    assert (is_good[3:] < 0.01).all()


def noise_of(errors, *, is_level_fixed=False):
    evidence = evidence_of(len(errors))
    return fitted_noise(evidence, errors, np.ones(len(errors)), stated_noise(evidence), np.array([is_level_fixed]))


@pytest.mark.parametrize(("level", "share"), [(1.0, 0.0), (1.0, 0.05), (0.8, 0.05), (1.7, 0.03)])
def test_level_and_share_are_those_that_were_drawn(level, share):
    rng = np.random.default_rng(4)
    errors = np.where(rng.random(4000) < share, WIDTH * rng.standard_cauchy(4000), level * rng.standard_normal(4000))
    noise = noise_of(errors)
    # Standard errors: level / sqrt(2 n) = 1.1 %, and sqrt(share / n) = 0.4 %.
    assert noise.levels[0] == pytest.approx(level, rel=0.035)
    assert noise.shares[0] == pytest.approx(share, abs=0.012)


def test_the_fitted_noise_has_the_least_cost():
    rng = np.random.default_rng(7)
    errors = 1.4 * rng.standard_normal(300)
    errors[:12] += 15.0
    noise = noise_of(errors)

    def total(level, share):
        each = NoiseFit(np.array([level]), np.array([share]))
        return costs_of_residuals(evidence_of(300), errors / level, np.full(300, level), each).sum() + each.prior_cost

    level, share = noise.levels[0], noise.shares[0]
    least = total(level, share)
    for factor in (0.98, 1.02):
        assert total(level * factor, share) > least
        assert total(level, share * factor) > least
    assert noise.prior_cost == pytest.approx((np.log(level) / LEVEL_SD) ** 2 + 2.0 * share / MEAN_SHARE)


def test_more_than_twice_the_stated_noise_is_no_error_of_the_statement():
    noise = noise_of(3.0 * np.random.default_rng(2).standard_normal(500))
    assert noise.levels[0] == pytest.approx(LEVELS[1])


def test_a_noise_that_is_not_stated_is_no_smaller_than_it_was_estimated():
    evidence = evidence_of(500, is_stated=False)
    errors = 0.3 * np.random.default_rng(2).standard_normal(500)
    noise = fitted_noise(evidence, errors, np.ones(500), stated_noise(evidence), np.array([False]))
    assert noise.levels[0] == 1.0


def test_where_an_effect_has_the_place_of_the_level_the_level_stays_as_stated():
    assert noise_of(1.6 * np.random.default_rng(2).standard_normal(500), is_level_fixed=True).levels[0] == 1.0

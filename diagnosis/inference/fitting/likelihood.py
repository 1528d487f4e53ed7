"""The cost of a hypothesis: minus twice the log-likelihood of the data, with the priors of the nuisances.

A reading is good, with normal noise, or an outlier, with a small probability (a contaminated normal distribution: Tukey
1960; Huber and Ronchetti, Robust Statistics, 2nd ed., section 1.1). The density of an outlier is a Cauchy density of
WIDTH stated sigmas: so wide that a good reading hardly ever counts as one, and with tails so heavy that a reading of
hundreds of sigmas costs no more than a few of three. It has a slope everywhere, so that a fit converges
also if it starts far from the data.

Two numbers of each observed quantity are nuisances of each fit: the share of outliers, and the level of the noise
relative to what is stated. Without the share, a few outliers would look like larger noise; without the level, a stated
noise that is too small would make every chance pattern significant. The share has an exponential prior, the level a
log-normal one. Both are estimated by expectation maximisation (Dempster, Laird and Rubin, J. Royal
Statist. Soc. B 39 (1977) 1-38).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.inference.evidence.evidence import Evidence, Prediction
from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array

CORNER = 3.0
"""Residual in sigmas at which a sample has half its weight in a linear test of the residuals."""
WIDTH = 10.0
"""Half width of the density of outliers at half its maximum, in sigmas of the stated noise."""
MEAN_SHARE = 0.02
"""Mean of the prior of the share of outliers."""
SHARES = (0.002, 0.1)
"""Smallest and largest share of outliers; more of them are no outliers."""
LEVEL_SD = 0.4
"""Standard deviation of the prior of the logarithm of the level; a uniform one within a factor of two has the same."""
LEVELS = (0.7, 2.0)
"""Smallest and largest level. A source may state half or twice the noise (GAP_FORMAT). The smallest level is nearer to
1 all the same, and it is 1 where the noise is not stated but estimated: readings that scatter far less than stated may
be simulated, and then errors of the integration would become significant."""
MAX_ROUNDS = 30
"""Limit for the rounds of expectation and maximisation; with a start nearby two or three are enough."""
SETTLED = 1e-3
"""Change of a share or of the logarithm of a level at which the rounds end."""
_PEAK = np.sqrt(2.0 * np.pi) / (np.pi * WIDTH)
"""Largest density of an outlier, relative to that of a good reading with the stated noise."""


@dataclass(frozen=True, eq=False)
class NoiseFit:
    """Nuisances of the noise of each of Q observed quantities."""

    levels: Array
    """(Q,), standard deviation of good readings, relative to that of the prediction."""
    shares: Array
    """(Q,), share of outliers."""

    @property
    def prior_cost(self) -> float:
        return float(((np.log(self.levels) / LEVEL_SD) ** 2).sum() + 2.0 * self.shares.sum() / MEAN_SHARE)


def stated_noise(evidence: Evidence) -> NoiseFit:
    """Return the noise as it is stated, with the usual share of outliers."""
    quantities = len(evidence.observed)
    return NoiseFit(np.ones(quantities), np.full(quantities, MEAN_SHARE))


def robust_weight(z: Array) -> Array:
    """Return the weight of a sample in a linear test of the residuals (Holland and Welsch, Commun. Stat. 6 (1977) 813).

    Unlike the weight in a fit, it does not vanish where a model is far from many rows: these are structure, and a test
    must see them.
    """
    return 1.0 / (1.0 + (z / CORNER) ** 2)


def residuals(evidence: Evidence, prediction: Prediction, noise: NoiseFit) -> Array:
    """Return the residuals (M, N) in sigmas of the fitted noise.

    They are 0 at samples that are not usable, and infinite at usable ones without a finite prediction, which must not
    be as cheap as a perfect one.
    """
    z = (evidence.values - prediction.mean) / (prediction.sd * noise.levels[evidence.quantity])
    return np.where(np.isfinite(z), z, np.where(evidence.fit | evidence.heldout, np.inf, 0.0))


def sample_costs(evidence: Evidence, prediction: Prediction, noise: NoiseFit) -> Array:
    """Return the cost of each sample (M, N), 0 if it is not usable and infinite without a finite prediction."""
    sd = prediction.sd * noise.levels[evidence.quantity]
    return costs_of_residuals(evidence, residuals(evidence, prediction, noise), sd, noise)


def costs_of_residuals(evidence: Evidence, z: Array, sd: Array, noise: NoiseFit) -> Array:
    """Return the cost of each sample.

    Args:
        evidence: The observations.
        z: (..., N), residuals in sigmas of the fitted noise.
        sd: (..., N), standard deviation of the fitted noise of a good reading.
        noise: Shares of outliers; its levels are part of `sd`.
    """
    is_not_predicted = np.isinf(z)
    good, outlier = _densities(evidence, np.where(is_not_predicted, 0.0, z), sd, noise)
    costs = np.where(np.isfinite(evidence.values), -2.0 * evidence.weight * np.log(good + outlier), 0.0)
    return np.where(is_not_predicted, np.inf, costs)


def weights(evidence: Evidence, z: Array, sd: Array, noise: NoiseFit) -> tuple[Array, Array]:
    """Return what a least-squares step needs, (..., N) each.

    Returns:
        The weight psi(z)/z of a sample, where psi is half the derivative of its cost by z; and the probability that it
        is a good reading.
    """
    good, outlier = _densities(evidence, z, sd, noise)
    is_good = good / (good + outlier)
    ratio = sd / evidence.sd
    return is_good + (1.0 - is_good) * 2.0 * ratio**2 / (WIDTH**2 + (z * ratio) ** 2), is_good


def cost(evidence: Evidence, prediction: Prediction, prior: Array, rows: Mask, noise: NoiseFit) -> Array:
    """Return the costs (M,) over some of the samples, with priors (M, Q) in standard deviations and of the noise."""
    costs = sample_costs(evidence, prediction, noise)[:, rows].sum(axis=1)
    return costs + (prior**2).sum(axis=1) + noise.prior_cost


def fitted_noise(evidence: Evidence, z: Array, sd: Array, start: NoiseFit, is_level_fixed: Mask) -> NoiseFit:
    """Return the levels and shares with the lowest cost over the rows of the fit.

    Args:
        evidence: The observations.
        z: (N,), residuals in sigmas of the predicted noise.
        sd: (N,), standard deviation of the predicted noise.
        start: Levels and shares at which the search begins.
        is_level_fixed: (Q,), quantities whose level stays 1, because an effect of the hypothesis changes it instead.
    """
    rows = np.flatnonzero(evidence.fit)
    quantity, count = evidence.quantity[rows], len(evidence.observed)
    weight, square = evidence.weight[rows], z[rows] ** 2
    ratio = sd[rows] / evidence.sd[rows]
    outlier = _PEAK / (1.0 + square * (ratio / WIDTH) ** 2)
    total = _sums(quantity, weight, count)
    # Expectation: how probably each reading is a good one. Maximisation: level and share of the posterior with these.
    lowest = np.array([LEVELS[0] if observed.noise_is_stated else 1.0 for observed in evidence.observed])
    level, share = np.where(is_level_fixed, 1.0, start.levels), start.shares
    for _ in range(MAX_ROUNDS):
        inverse = 1.0 / level[quantity]
        good = (1.0 - share[quantity]) * inverse / ratio * np.exp(-0.5 * square * inverse**2)
        is_good = weight * good / (good + share[quantity] * outlier)
        readings = _sums(quantity, is_good, count)
        squares = _sums(quantity, is_good * square, count)
        new_share = _share(total - readings, readings)
        new_level = np.where(is_level_fixed, 1.0, np.maximum(_level(readings, squares, level), lowest))
        change = max(np.abs(new_share - share).max(initial=0.0), np.abs(np.log(new_level / level)).max(initial=0.0))
        level, share = new_level, new_share
        if change < SETTLED:
            break
    return NoiseFit(level, share)


def _densities(evidence: Evidence, z: Array, sd: Array, noise: NoiseFit) -> tuple[Array, Array]:
    """Return the densities (..., N) as good reading and as outlier, relative to the largest one as stated."""
    share = noise.shares[evidence.quantity]
    ratio = sd / evidence.sd
    good = (1.0 - share) / ratio * np.exp(-0.5 * z**2)
    return good, share * _PEAK / (1.0 + (z * ratio / WIDTH) ** 2)


def _sums(quantity: NDArray[np.int64], values: Array, count: int) -> Array:
    """Return the sums (Q,) of values (n,) by quantity."""
    return np.bincount(quantity, values, count).astype(np.float64)


def _share(outliers: Array, good: Array) -> Array:
    """Return the shares (Q,) of the largest posterior density, from the expected numbers of both kinds."""
    rate = 1.0 / MEAN_SHARE
    total = outliers + good + rate
    # The root of rate p^2 - total p + outliers, where the derivative by p of the log-posterior vanishes.
    return np.clip((total - np.sqrt(total**2 - 4.0 * outliers * rate)) / (2.0 * rate), *SHARES)


def _level(good: Array, squares: Array, level: Array) -> Array:
    """Return the levels (Q,) of the largest posterior density, by Newton's method in their logarithm."""
    x = np.log(level)
    for _ in range(3):
        scaled = squares * np.exp(-2.0 * x)
        slope = scaled - good - x / LEVEL_SD**2
        x = np.clip(x + slope / (2.0 * np.maximum(scaled, 0.5 * good) + LEVEL_SD**-2), *np.log(LEVELS))
    return np.exp(x)

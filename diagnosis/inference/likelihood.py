"""The cost of a hypothesis: minus twice a robust log-likelihood of the data, with the prior of the nuisances.

A sample costs the Cauchy loss of its standardised residual z (Holland and Welsch, Commun. Stat. 6 (1977) 813-827): z^2
near zero, and its logarithm beyond CORNER, so that one wild reading of hundreds of sigmas costs no more than a few of
three. With a linear loss, one such reading could justify ten times the noise. Unlike a loss that levels off, it still
has a slope where a whole model is far from the data. Where an effect changes the noise, the log sd of the normal
density is added, times the mean of z psi(z), without which wide noise would be too cheap.
"""

from collections.abc import Callable
from statistics import NormalDist

import numpy as np
from scipy.integrate import quad

from diagnosis.inference.evidence.evidence import Evidence, Prediction
from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array

CORNER = 3.0
"""Residual in sigmas at which a sample has half its weight. Of normal noise, a twentieth of the information is lost."""


def mean_over_normal(function: Callable[[float], float]) -> float:
    """Return the mean of a function over a standard normal deviate."""
    return quad(lambda z: function(z) * NormalDist().pdf(z), -12.0, 12.0)[0]


def loss(z: Array) -> Array:
    return CORNER**2 * np.log1p((z / CORNER) ** 2)


def robust_weight(z: Array) -> Array:
    """Return psi(z)/z, the weight of a sample in a least-squares step."""
    return 1.0 / (1.0 + (z / CORNER) ** 2)


def root_weights(evidence: Evidence, z: Array) -> Array:
    """Return the roots of the weights of samples with residuals z (N,) in a least-squares step; 0 outside the fit."""
    return np.where(evidence.fit, np.sqrt(evidence.weight * robust_weight(z)), 0.0)


SPREAD = mean_over_normal(lambda z: z * z / (1.0 + (z / CORNER) ** 2))
"""Mean of z psi(z) over standard normal z."""


def residuals(evidence: Evidence, prediction: Prediction) -> Array:
    """Return the standardised residuals (M, N); 0 at samples that are not usable."""
    z = (evidence.values - prediction.mean) / prediction.sd
    return np.where(np.isfinite(z), z, 0.0)


def sample_costs(evidence: Evidence, prediction: Prediction) -> Array:
    """Return the cost of each sample (M, N); 0 at samples that are not usable."""
    return costs_of_residuals(evidence, residuals(evidence, prediction), prediction.sd)


def costs_of_residuals(evidence: Evidence, z: Array, sd: Array) -> Array:
    """Return the cost of each sample (..., N) from its residual and the standard deviation of its noise, (..., N)."""
    log_spread = np.log(sd / evidence.sd)
    usable = np.isfinite(evidence.values)
    return np.where(usable, evidence.weight * (loss(z) + 2.0 * SPREAD * np.where(usable, log_spread, 0.0)), 0.0)


def cost(evidence: Evidence, prediction: Prediction, prior: Array, rows: Mask) -> Array:
    """Return the costs (M,) over some of the samples, with priors (M, Q) in standard deviations."""
    return sample_costs(evidence, prediction)[:, rows].sum(axis=1) + (prior**2).sum(axis=1)

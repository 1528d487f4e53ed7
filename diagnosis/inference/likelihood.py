"""How badly a hypothesis explains the data: a robust twice-negative log-likelihood, with the prior of the nuisances.

A sample costs the Cauchy loss of its standardised residual z (Holland and Welsch, Commun. Stat. 6 (1977) 813-827): z^2
near zero, and the logarithm of it beyond CORNER, so that one wild reading of hundreds of sigmas costs no more than a
few of three. A linear loss would let it buy ten times the noise. Unlike a loss that levels off, it still pulls where a
whole model is far away. Where an effect changes the noise, the normal density's log sd joins it, times the mean of
z psi(z), without which wide noise would be too cheap.
"""

from collections.abc import Callable
from statistics import NormalDist

import numpy as np
from scipy.integrate import quad

from diagnosis.inference.evidence.evidence import Evidence, Prediction
from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array

CORNER = 3.0
"""Sigmas at which a sample counts half; costs a twentieth of the information of normal noise."""


def mean_over_normal(of_z: Callable[[float], float]) -> float:
    """Over a standard normal deviate z."""
    return quad(lambda z: of_z(z) * NormalDist().pdf(z), -12.0, 12.0)[0]


def loss(z: Array) -> Array:
    return CORNER**2 * np.log1p((z / CORNER) ** 2)


def robust_weight(z: Array) -> Array:
    """psi(z)/z, by which a sample counts in a least-squares step."""
    return 1.0 / (1.0 + (z / CORNER) ** 2)


SPREAD = mean_over_normal(lambda z: z * z / (1.0 + (z / CORNER) ** 2))
"""Mean of z psi(z) over standard normal z."""


def residuals(evidence: Evidence, prediction: Prediction) -> Array:
    """(M, N), standardised; 0 at samples that are not usable."""
    z = (evidence.values - prediction.mean) / prediction.sd
    return np.where(np.isfinite(z), z, 0.0)


def sample_costs(evidence: Evidence, prediction: Prediction) -> Array:
    """(M, N), of each sample; 0 at those not usable."""
    return costs_of_residuals(evidence, residuals(evidence, prediction), prediction.sd)


def costs_of_residuals(evidence: Evidence, z: Array, sd: Array) -> Array:
    """(..., N), of each sample by its residual and the standard deviation of its noise, (..., N)."""
    wider = np.log(sd / evidence.sd)
    usable = np.isfinite(evidence.values)
    return np.where(usable, evidence.weight * (loss(z) + 2.0 * SPREAD * np.where(usable, wider, 0.0)), 0.0)


def cost(evidence: Evidence, prediction: Prediction, prior: Array, rows: Mask) -> Array:
    """(M,), over some of the samples, with priors (M, Q) in standard deviations."""
    return sample_costs(evidence, prediction)[:, rows].sum(axis=1) + (prior**2).sum(axis=1)

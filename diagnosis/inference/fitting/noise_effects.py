"""Effects of the noise beside its level, which is a nuisance of every fit.

An effect that changes the noise of all samples in nearly the same proportion imitates the level. If fit and level were
improved in turn, each would follow the other along a valley of the cost in tiny steps, and the fit would end far from
its lowest point. So the noise is fitted again at every point that is compared.
"""

import numpy as np

from configs.effects.base import Slot
from diagnosis.inference.evidence.evidence import Evidence, Prediction
from diagnosis.inference.fitting.hypothesis import Hypothesis
from diagnosis.inference.fitting.likelihood import LEVEL_SD, NoiseFit, cost, fitted_noise, residuals, stated_noise
from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array

EVEN = 0.9
"""Ratio of the smallest to the largest change of log sd by an effect, from which it scales the noise as a whole and
takes the place of its level. A factor on the noise is not quite even, since rounding adds to it. With an effect that is
less even, the level stays uncertain."""


def has_noise_effect(hypothesis: Hypothesis) -> bool:
    return any(effect.kind.slot is Slot.RANGE_NOISE for effect in hypothesis.effects)


def costs_with_fitted_noise(
    evidence: Evidence, prediction: Prediction, prior: Array, start: NoiseFit, is_level_fixed: Mask
) -> Array:
    """Return the costs (M,) over the rows of the fit, each with the noise that is fitted to its prediction.

    Args:
        evidence: The observations.
        prediction: Of M robots.
        prior: (M, Q), deviations of the nuisances in standard deviations.
        start: Noise at which the search begins.
        is_level_fixed: (Q,), quantities whose level stays 1, because an effect changes it instead.
    """
    z = residuals(evidence, prediction, stated_noise(evidence))
    lost = np.isinf(z)
    z, sd = np.where(lost, 0.0, z), np.where(lost, evidence.sd, prediction.sd)
    costs = np.empty(len(z))
    for k in range(len(z)):
        noise = fitted_noise(evidence, z[k], sd[k], start, is_level_fixed)
        costs[k] = cost(evidence, prediction.some(slice(k, k + 1)), prior[k : k + 1], evidence.fit, noise)[0]
    return costs


def information_of_levels(evidence: Evidence, hypothesis: Hypothesis, spreads: Array, is_good: Array) -> Array:
    """Return the information (P, P) about effects of the noise that is lost since the levels are not known.

    It is the Schur complement of the levels in the joint information. `is_good` are the weights of the rows of the fit.
    """
    lost = np.zeros((len(spreads), len(spreads)))
    is_level_fixed = fixed_levels(evidence, hypothesis, spreads)
    quantity = evidence.quantity[evidence.fit]
    for k in np.flatnonzero(~is_level_fixed).tolist():
        quantity_weights = np.where(quantity == k, is_good, 0.0)
        shared = 2.0 * spreads[:, evidence.fit] @ quantity_weights
        lost += np.outer(shared, shared) / (2.0 * quantity_weights.sum() + LEVEL_SD**-2)
    return lost


def fixed_levels(evidence: Evidence, hypothesis: Hypothesis, spreads: Array) -> Mask:
    """Return the quantities (Q,) whose noise an effect scales as a whole, so that it has the place of the level."""
    is_level_fixed = np.zeros(len(evidence.observed), dtype=bool)
    for effect in hypothesis.effects:
        if effect.kind.slot is not Slot.RANGE_NOISE:
            continue
        change = np.abs(spreads[hypothesis.parameters(effect)]).sum(axis=0)
        for k, place in enumerate(evidence.places):
            inside = change[place][evidence.fit[place]]
            is_level_fixed[k] |= bool(len(inside) and inside.min() > EVEN * inside.max())
    return is_level_fixed

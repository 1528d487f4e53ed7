"""Standard errors of an effect's parameters, also where the cost is no parabola.

The curvature of the cost at a fit is only the width of a parabola. A little friction decides when a motor starts, and a
little play when a gear meets: beyond such an event the cost may hardly rise any more, although it is steep before it. A
few predictions along the valley of the parabola show this. There the cost is an upper limit of its profile, so that a
small rise proves that the parameter may be further off than the curvature says.
"""

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.fitting.likelihood import cost
from diagnosis.inference.fitting.noise_effects import costs_with_fitted_noise, fixed_levels, has_noise_effect
from diagnosis.inference.fitting.profile import profiles
from symolo.core.arrays import Array

SIGMAS = 3.0
"""Distance at which the rise of the cost is compared with that of the parabola, in standard errors."""
LEVEL = 0.9973
"""Probability that a normal deviate is within SIGMAS."""
FLAT = 0.5
"""Share of the parabola's rise, below which the profile is computed."""


def standard_errors(evidence: Evidence, fit: HypothesisFit, effect: CandidateEffect) -> dict[str, float]:
    """Return the standard errors of an effect's parameters, in their units.

    These are by the curvature of the cost, or a third of the longer half of the profile interval at three standard
    errors, if the cost rises much less than its curvature says and that third is larger.
    """
    by_curvature = fit.std(effect)
    if fit.is_of_whole_runs or not _is_flat(evidence, fit, effect):
        return by_curvature
    intervals = profiles(evidence, fit, (LEVEL,), (effect,))[effect.name]
    values = fit.hypothesis.values(effect, fit.x)
    halves = {n: max(values[n] - interval.low, interval.high - values[n]) for n, (interval,) in intervals.items()}
    return {name: max(std, halves.get(name, 0.0) / SIGMAS) for name, std in by_curvature.items()}


def _is_flat(evidence: Evidence, fit: HypothesisFit, effect: CandidateEffect) -> bool:
    """Return whether the cost rises much less along some parameter of an effect than its curvature says."""
    x, rises = _along_valleys(fit, effect)
    if not len(x):
        return False
    hypothesis = fit.hypothesis
    prediction = evidence.predicted(hypothesis.robots(x)).moved(evidence.whitened(hypothesis.local_change(x)))
    prior = hypothesis.prior(x)
    if has_noise_effect(hypothesis):
        is_level_fixed = fixed_levels(evidence, hypothesis, fit.spreads)
        costs = costs_with_fitted_noise(evidence, prediction, prior, fit.noise, is_level_fixed)
    else:
        costs = cost(evidence, prediction, prior, evidence.fit, fit.noise)
    return bool(np.any(costs - fit.cost < FLAT * rises))


def _along_valleys(fit: HypothesisFit, effect: CandidateEffect) -> tuple[Array, Array]:
    """Return coordinates (M, P) up to SIGMAS from a fit to both sides of each parameter, and the parabola's rises (M,).

    All other coordinates are where the parabola has its valley. Steps that leave the bounds are made shorter.
    """
    hypothesis = fit.hypothesis
    low, high = hypothesis.bounds
    covariance = np.where(np.isfinite(fit.covariance), fit.covariance, 0.0)
    steps, rises = [], []
    for place in range(*hypothesis.parameters(effect).indices(len(fit.x))):
        std = np.sqrt(covariance[place, place])
        if not std > 0.0:
            continue
        for step in (-SIGMAS * covariance[place] / std, SIGMAS * covariance[place] / std):
            room = np.where(step > 0.0, high - fit.x, fit.x - low)
            share = min(1.0, float(np.min(room[step != 0.0] / np.abs(step[step != 0.0]))))
            if share > 0.0:
                steps.append(fit.x + share * step)
                rises.append((share * SIGMAS) ** 2)
    return np.array(steps).reshape(-1, len(fit.x)), np.array(rises)

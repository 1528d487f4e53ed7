"""Penalty for the parameters of a model, so that models with different numbers of parameters can be compared."""

from diagnosis.inference.fitting.fit import HypothesisFit

PARAMETER_PENALTY = 6.0
"""Penalty for each parameter: the logarithm of some hundreds of rows, as in the Bayesian information criterion
(Schwarz, Ann. Statist. 6 (1978) 461-464)."""


def parameter_penalty(fit: HypothesisFit) -> float:
    """Return the penalty for the parameters of all effects of a fit."""
    return sum(PARAMETER_PENALTY * len(effect.coordinates) for effect in fit.hypothesis.effects)

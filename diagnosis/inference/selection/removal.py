"""Fits without one of their effects, and effects that cancel each other.

Two effects that nearly undo each other leave a small difference, which may imitate anything. Where one of them explains
much by itself, this is no coincidence: the other one was hidden behind it.
"""

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.memoized import memoized
from diagnosis.inference.fitting.fit import FAR, HypothesisFit, fits
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis, moved
from diagnosis.inference.selection.refusal import needed
from diagnosis.inference.unexplained.adequacy import change_by
from symolo.core.arrays import Array

CANCELLED = 0.5
"""Ratio of the size of the sum of two changes to that of the smaller one, below which they cancel each other."""


@memoized
def without(evidence: Evidence, fit: HypothesisFit, effect: CandidateEffect) -> HypothesisFit:
    """Return the fit without one effect."""
    fewer = fit.hypothesis.without(effect)
    if not fewer.effects:
        return without_effects(evidence, fewer)
    (base,) = fits(evidence, [(fewer, moved(fit.x, fit.hypothesis, fewer))], fit.cost + FAR)
    return base


@memoized
def without_effects(evidence: Evidence, nominal: Hypothesis) -> HypothesisFit:
    """Return the fit of a hypothesis that has no effects."""
    (base,) = fits(evidence, [(nominal, nominal.null())])
    return base


def cancelled_by(evidence: Evidence, nominal: HypothesisFit, fit: HypothesisFit, effect: CandidateEffect) -> str:
    """Return the name of another effect of a fit that undoes what this one does; empty if there is none.

    Args:
        evidence: The observations.
        nominal: The fit without effects.
        fit: The fit with the effects.
        effect: One of them.
    """
    others = [other for other in fit.hypothesis.effects if other != effect]
    if not others:
        return ""
    change = change_by(evidence, nominal, fit, effect)
    cancelling = (other for other in others if cancel(change, change_by(evidence, nominal, fit, other)))
    return next((other.name for other in cancelling if not _is_seen_alone(evidence, fit, (effect, other))), "")


def _is_seen_alone(evidence: Evidence, fit: HypothesisFit, pair: tuple[CandidateEffect, CandidateEffect]) -> bool:
    """Return whether one of two effects of a fit would be accepted without the other."""
    one, other = pair
    neither = without(evidence, without(evidence, fit, one), other)
    return any(
        neither.cost - without(evidence, fit, left_out).cost >= needed(alone)
        for left_out, alone in ((one, other), (other, one))
    )


def cancel(change: Array, other: Array) -> bool:
    """Return whether two changes (N,) of a prediction nearly undo each other."""
    size = min(float(np.linalg.norm(change)), float(np.linalg.norm(other)))
    return float(np.linalg.norm(change + other)) < CANCELLED * size

"""Alternatives to a named effect, and the confidence in its name.

Every promising candidate is fitted in place of the effect, with all else fitted again. Effects that cost at most
AS_GOOD more cannot be distinguished by the data, and are reported. That there is no effect at all is an alternative
too; it is as good as the effect if the fall of the cost is just the threshold for naming one. The confidence in a name
is its weight among all alternatives, each by exp(-cost/2) (Akaike weights: Burnham and Anderson, Model Selection and
Multimodel Inference, 2nd ed., section 2.9), tempered. One or two effects also compete with pairs of others, and an
effect of the noise with a statement that is wrong. Held-out rows count here, though not in the selection: whatever
comes near the named effect is fitted to all rows. Predictions of the held-out rows would instead count against a rival
what the other rows cannot know, such as a friction in the one direction. Causes that are in no list have the weight of
the best simple form of an error (`unexplained/unlisted.py`) and a constant one. Temperature and constant were set on
the cases `wide_a` (docs/diagnosis_evaluation.md), where 97 % of the surest names were right.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import exp
from typing import cast

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import Contest, HypothesisFit, fits, fits_of_contests
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.fitting.likelihood import LEVELS
from diagnosis.inference.selection.penalty import parameter_penalty
from diagnosis.inference.selection.refusal import STATED_WITHIN, is_negligible, is_within_statement, needed, refusal
from diagnosis.inference.selection.removal import without
from diagnosis.inference.selection.stepwise import BEAM_SAMPLES, IMITATES, extended, replaced
from diagnosis.inference.unexplained.unlisted import advantage
from sensors.effects.range_sensor.noise_scale import NoiseScale
from sensors.effects.range_sensor.range_wander import RangeWander

AS_GOOD = 4.6
"""Increase of the cost up to which a rival explains the data as well: its weight is then a tenth of the name's."""

STATEMENT = f"a stated noise that is wrong by a factor of {STATED_WITHIN:g}"
NEAR = 20.0
"""Rise of the cost up to which a rival is fitted to all rows; at the end of it, its weight is below a hundredth of the
name's."""
RIVALS_IN_PAIRS = 2
"""Number of near rivals that are fitted with another effect."""
FORM = "an error of simple form, whose cause is in no list,"
SECOND = 6.0
"""Rise of the cost that counts as much as that two given effects are rarer than one: twice the logarithm of the number
of effects that the second may be, about twenty."""
TEMPERATURE = 2.0
"""Divisor of differences of the cost in the weights. Stated noise, tolerances and laws are only nearly right, so that a
difference says less than it would if they were right."""
SOMETHING_ELSE = 0.028
"""Weight of a cause that is in no list, relative to that of the named effect."""
SOMETHING_ELSE_BESIDE = 0.3
"""The same beside a structure that is unexplained, or where the noise is at the end of its range: the cause, which is
unknown, may be that of the effect too. Of the names beside a structure in 800 independent benches
(docs/diagnosis_evaluation.md), 8 of 11 were right."""


@dataclass(frozen=True)
class Rival:
    """Another effect in place of the named one."""

    effect: CandidateEffect
    worse: float
    """Increase of the cost of all rows over the named effect, with a penalty for each parameter."""
    fit: HypothesisFit
    refused: str
    """Why the rival is not accepted although it explains more; empty if it is, or if it does not explain more."""


@dataclass(frozen=True)
class RivalComparison:
    """A named effect among its rivals."""

    effect: CandidateEffect
    confidence: float
    rivals: tuple[Rival, ...]
    """All rivals that were tried, the closest first."""
    others: tuple[tuple[str, float], ...] = ()
    """What else would explain the data, in words, and the increase of the cost, the closest first."""
    is_whole: bool = True
    """Whether the model leaves neither a structure with an unknown cause nor a noise that cannot be as stated."""
    by_chance: float = np.inf
    """Increase of the cost without any effect, beyond the threshold for naming one."""

    drift_worse: float = np.inf
    """Increase of the cost with a random drift of the ranges in the place of the effect."""

    @property
    def closest(self) -> tuple[str, float] | None:
        """Name of the closest accepted rival and the increase of the cost with it; None if there is none."""
        accepted = [(rival.effect.name, rival.worse) for rival in self.rivals if not rival.refused]
        drift = [(RangeWander.name, self.drift_worse)] if np.isfinite(self.drift_worse) else []
        return min([*accepted, *drift], key=lambda rival: rival[1], default=None)

    @property
    def ambiguous_with(self) -> tuple[str, ...]:
        near = [(rival.worse, rival.effect.name) for rival in self.rivals] + [(self.drift_worse, RangeWander.name)]
        return tuple(name for worse, name in sorted(near, key=lambda each: each[0]) if worse < AS_GOOD)


def compare_rivals(
    evidence: Evidence,
    fit: HypothesisFit,
    effect: CandidateEffect,
    effects: Sequence[CandidateEffect],
    *,
    pairs: Sequence[HypothesisFit] = (),
    is_whole: bool = True,
) -> RivalComparison:
    """Compare one effect of a fit with all candidates.

    Args:
        evidence: The observations.
        fit: The fit with the effect.
        effect: The effect.
        effects: All candidates.
        pairs: Fits with two effects each, which compete with a single one and with other pairs.
        is_whole: Whether the fit leaves no structure with an unknown cause.
    """
    rivals = []
    base = without(evidence, fit, effect)
    candidates = [
        candidate
        for candidate in replaced(evidence, fit, effect, base, effects)
        if not is_negligible(candidate, candidate.hypothesis.added_to(fit.hypothesis))
    ]
    for candidate, worse in zip(candidates, rises_over(evidence, fit, candidates), strict=True):
        other = candidate.hypothesis.added_to(fit.hypothesis)
        # Only a rival that would win must pass the tests of the selection; others are reported as they are.
        refused = refusal(evidence, base, candidate, other) if worse < 0.0 else ""
        rivals.append(Rival(other, worse, candidate, refused))
    beside = pairs or _pairs_of_rivals(evidence, fit, rivals, effects)
    others = [
        (FORM, -advantage(evidence, base, fit)),
        *_best_pair(evidence, fit, beside),
        *_rise_by_statement(evidence, fit, effect),
    ]
    # A noise at the end of its range is more than a wrong statement, so that something else is behind it.
    is_whole = is_whole and float(fit.noise.levels.max()) < LEVELS[1]
    else_weight = SOMETHING_ELSE if is_whole else SOMETHING_ELSE_BESIDE
    rises = [rival.worse for rival in rivals] + [rise for _, rise in others]
    by_chance = base.cost - fit.cost - needed(effect)
    certainty = confidence(rises, by_chance, else_weight)
    closest_others = tuple(sorted(others, key=lambda other: other[1]))
    return RivalComparison(
        effect, certainty, tuple(sorted(rivals, key=lambda rival: rival.worse)), closest_others, is_whole, by_chance
    )


def rises_over(evidence: Evidence, fit: HypothesisFit, others: Sequence[HypothesisFit]) -> list[float]:
    """Return the rises of the cost of all rows with each of some other fits, with the penalties of both."""
    penalties = [parameter_penalty(other) - parameter_penalty(fit) for other in others]
    rises = [other.whole_cost - fit.whole_cost + penalty for other, penalty in zip(others, penalties, strict=True)]
    near = [
        min(rise, other.cost - fit.cost + penalty) <= NEAR
        for other, rise, penalty in zip(others, rises, penalties, strict=True)
    ]
    if not any(near):
        return rises
    costs = _costs_of_all_rows(
        evidence, [fit, *(other for other, is_near in zip(others, near, strict=True) if is_near)]
    )
    return [
        costs[other] - costs[fit] + penalty if is_near else rise
        for other, rise, penalty, is_near in zip(others, rises, penalties, near, strict=True)
    ]


def _costs_of_all_rows(evidence: Evidence, several: Sequence[HypothesisFit]) -> dict[HypothesisFit, float]:
    """Return the cost of each hypothesis, fitted to the held-out rows as well; those not known yet side by side."""
    keys = {fit: (_costs_of_all_rows, fit) for fit in several}
    new = [fit for fit, key in keys.items() if key not in evidence.memo]
    evidence.memo.update({keys[fit]: cost for fit, cost in zip(new, _fitted_to_all_rows(evidence, new), strict=True)})
    return {fit: cast("float", evidence.memo[key]) for fit, key in keys.items()}


def _fitted_to_all_rows(evidence: Evidence, several: Sequence[HypothesisFit]) -> list[float]:
    """Return the costs of hypotheses that are fitted to the held-out rows as well."""
    if not evidence.heldout.any():
        return [fit.cost for fit in several]
    if not several:
        return []
    none = np.zeros_like(evidence.heldout)
    all_rows = evidence.with_rows(fit=evidence.fit | evidence.heldout, heldout=none)
    refits = fits_of_contests([Contest(all_rows, [(fit.hypothesis, fit.x)]) for fit in several])
    return [refit.cost for (refit,) in refits]


def _pairs_of_rivals(
    evidence: Evidence, fit: HypothesisFit, rivals: Sequence[Rival], effects: Sequence[CandidateEffect]
) -> list[HypothesisFit]:
    """Return pairs of a near rival and another effect, where a number far off beside a single name may hide the other.

    With few rows, the selection has compared pairs already.
    """
    imitated = float(np.abs(fit.x[: len(fit.hypothesis.nuisances)]).max(initial=0.0)) >= IMITATES
    if len(fit.hypothesis.effects) != 1 or not imitated or np.count_nonzero(evidence.fit) <= BEAM_SAMPLES:
        return []
    others = [effect for effect in effects if effect.kind is not fit.hypothesis.effects[0].kind]
    near = sorted((rival for rival in rivals if rival.worse < NEAR), key=lambda rival: rival.worse)
    return [pair for rival in near[:RIVALS_IN_PAIRS] for pair in extended(evidence, rival.fit, others)]


def _best_pair(evidence: Evidence, fit: HypothesisFit, pairs: Sequence[HypothesisFit]) -> list[tuple[str, float]]:
    """Return the best two effects in place of a single one or of both, and the rise of the cost; empty if none.

    Two effects that share one with the fit are among the rivals of the other one.
    """
    if len(fit.hypothesis.effects) > 2:
        return []
    kinds = {other.kind for other in fit.hypothesis.effects}
    others = [
        pair
        for pair in pairs
        if kinds.isdisjoint(other.kind for other in pair.hypothesis.effects)
        # A factor by which a statement may be wrong is no effect.
        and not any(is_within_statement(pair, other) for other in pair.hypothesis.effects)
    ]
    if not others:
        return []
    rises = rises_over(evidence, fit, others)
    rise, best = min(zip(rises, others, strict=True), key=lambda each: each[0])
    names = " and ".join(other.name for other in best.hypothesis.effects)
    return [(f"{names} together", rise + SECOND) if len(kinds) == 1 else (f"{names} in place of both", rise)]


def _rise_by_statement(evidence: Evidence, fit: HypothesisFit, effect: CandidateEffect) -> list[tuple[str, float]]:
    """Return the rise of the cost if the stated noise is wrong by the largest factor that needs no effect."""
    if effect.kind is not NoiseScale:
        return []
    place = fit.hypothesis.parameters(effect).start
    null = float(fit.hypothesis.null()[place])
    at = null + float(np.copysign(np.log(STATED_WITHIN), fit.x[place] - null))
    x = fit.x.copy()
    x[place] = at
    (fixed,) = fits(evidence, [(fit.hypothesis.with_fixed(place, at), x)])
    return [(STATEMENT, fixed.whole_cost - fit.whole_cost)]


def with_random_drift(comparison: RivalComparison, worse: float) -> RivalComparison:
    """Return the comparison with a random drift of the ranges, which costs more by a number, as a further rival."""
    if not np.isfinite(worse):
        return comparison
    certainty = 1.0 / (1.0 / max(comparison.confidence, 1e-9) + relative_weight(max(worse, -50.0)))
    others = (*comparison.others, (RangeWander.name, worse))
    others = tuple(sorted(others, key=lambda other: other[1]))
    return replace(comparison, confidence=certainty, others=others, drift_worse=worse)


def relative_weight(rise: float) -> float:
    """Return the weight of a model whose cost is `rise` above that of the best one (tempered Akaike weight)."""
    return exp(-0.5 * rise / TEMPERATURE)


def confidence(rises: Iterable[float], rise_without: float, something_else: float = SOMETHING_ELSE) -> float:
    """Return the Akaike weight of a named effect among all alternatives.

    Args:
        rises: Increase of the cost with each rival in place of the effect.
        rise_without: Increase of the cost without any effect, beyond the threshold for naming one.
        something_else: Weight of a cause that is in no list.
    """
    # The lower limit only prevents an overflow: with such a rival the confidence is 0 anyway.
    weights = sum(relative_weight(max(rise, -50.0)) for rise in rises)
    return 1.0 / (1.0 + weights + relative_weight(max(rise_without, 0.0)) + something_else)

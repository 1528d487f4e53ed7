"""Alternatives to a named effect, and the confidence in its name.

Every promising candidate is fitted in place of the effect, with all else fitted again. Effects that cost at most
AS_GOOD more cannot be distinguished by the data, and are reported. That there is no effect at all is an alternative
too; it is as good as the effect if the fall of the cost is just the threshold for naming one. The confidence in a name
is its weight among all alternatives, each by exp(-cost/2) (Akaike weights: Burnham and Anderson, Model Selection and
Multimodel Inference, 2nd ed., section 2.9), tempered, and with a constant weight for causes that are in no list. Both
numbers were set on the cases `wide_a` (docs/diagnosis_evaluation.md), where 97 % of the surest names were right.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import exp

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fit import HypothesisFit
from diagnosis.inference.hypothesis import CandidateEffect
from diagnosis.inference.refusal import is_negligible, needed, refusal
from diagnosis.inference.selection import TOLL, replaced, without

AS_GOOD = 4.6
"""Increase of the cost up to which a rival explains the data as well: its weight is then a tenth of the name's."""

TEMPERATURE = 2.0
"""Divisor of differences of the cost in the weights. Stated noise, tolerances and laws are only nearly right, so that a
difference says less than it would if they were right."""
SOMETHING_ELSE = 0.028
"""Weight of a cause that is in no list, relative to that of the named effect."""


@dataclass(frozen=True)
class Rival:
    """Another effect in place of the named one."""

    effect: CandidateEffect
    worse: float
    """Increase of the cost over the named effect, with a toll for each parameter."""
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

    @property
    def ambiguous_with(self) -> tuple[str, ...]:
        return tuple(rival.effect.name for rival in self.rivals if rival.worse < AS_GOOD)


def compare_rivals(
    evidence: Evidence, fit: HypothesisFit, effect: CandidateEffect, effects: Sequence[CandidateEffect]
) -> RivalComparison:
    """Compare one effect of a fit with all candidates."""
    rivals = []
    base = without(evidence, fit, effect)
    for candidate in replaced(evidence, fit, effect, base, effects):
        other = candidate.hypothesis.added_to(fit.hypothesis)
        if is_negligible(candidate, other):
            continue
        # Only a rival that would win must pass the tests of the selection; others are reported as they are.
        worse = candidate.cost - fit.cost + TOLL * (len(other.coordinates) - len(effect.coordinates))
        refused = refusal(evidence, base, candidate, other) if worse < 0.0 else ""
        rivals.append(Rival(other, worse, candidate, refused))
    certainty = confidence((rival.worse for rival in rivals), base.cost - fit.cost - needed(effect))
    return RivalComparison(effect, certainty, tuple(sorted(rivals, key=lambda rival: rival.worse)))


def confidence(rises: Iterable[float], rise_without: float) -> float:
    """Return the Akaike weight of a named effect among all alternatives.

    Args:
        rises: Increase of the cost with each rival in place of the effect.
        rise_without: Increase of the cost without any effect, beyond the threshold for naming one.
    """
    # The lower limit only prevents an overflow: with such a rival the confidence is 0 anyway.
    weights = sum(exp(-0.5 * max(rise, -50.0) / TEMPERATURE) for rise in rises)
    return 1.0 / (1.0 + weights + exp(-0.5 * max(rise_without, 0.0) / TEMPERATURE) + SOMETHING_ELSE)

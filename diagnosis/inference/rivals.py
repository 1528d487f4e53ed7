"""Which other names explain the data as well, and how sure a name is.

Every promising candidate is fitted in the place of a named effect, all else fitted anew. What costs at most AS_GOOD
more cannot be told apart by these data, and is said. That nothing is there is a rival too, as good as the effect where
the fall of the cost is just what names one. The confidence of a name is its weight among all that were tried, each by
exp(-cost/2) (Akaike weights: Burnham and Anderson, Model Selection and Multimodel Inference, 2nd ed., section 2.9).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fit import Fit
from diagnosis.inference.hypothesis import CandidateEffect
from diagnosis.inference.selection import TOLL, is_negligible, needed, refusal, replaced, without

AS_GOOD = 6.0
"""Cost more, three units of log-likelihood, up to which a rival explains the data as well."""


@dataclass(frozen=True)
class Rival:
    effect: CandidateEffect
    worse: float
    """Cost more than with the named effect, numbers counted."""
    fit: Fit
    refused: str
    """Why it would not be believed though it explains more; empty if it would, or if it explains no more."""


@dataclass(frozen=True)
class RivalComparison:
    """A named effect among its rivals."""

    effect: CandidateEffect
    confidence: float
    rivals: tuple[Rival, ...]
    """All that were tried, the closest first."""

    @property
    def ambiguous_with(self) -> tuple[str, ...]:
        return tuple(rival.effect.name for rival in self.rivals if rival.worse < AS_GOOD)


def compare_rivals(
    evidence: Evidence, fit: Fit, effect: CandidateEffect, effects: Sequence[CandidateEffect]
) -> RivalComparison:
    """Of one effect of a fit, among all candidates."""
    tried = []
    base = without(evidence, fit, effect)
    for found in replaced(evidence, fit, effect, base, effects):
        (other,) = (e for e in found.hypothesis.effects if e not in fit.hypothesis.effects)
        if is_negligible(found, other):
            continue
        more = len(other.coordinates) - len(effect.coordinates)
        worse = found.cost - fit.cost + TOLL * more
        tried.append(Rival(other, worse, found, refusal(evidence, base, found, other) if worse < 0.0 else ""))
    weights = [exp(-0.5 * max(rival.worse, -50.0)) for rival in tried]
    nothing = exp(-0.5 * max(base.cost - fit.cost - needed(effect), 0.0))
    return RivalComparison(
        effect, 1.0 / (1.0 + sum(weights) + nothing), tuple(sorted(tried, key=lambda rival: rival.worse))
    )

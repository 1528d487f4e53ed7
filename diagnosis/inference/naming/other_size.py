"""The size that a named effect would have beside a second effect, which the rows hint at without naming it.

Two effects may nearly cancel each other, such as a pose that is late and a range sensor that reads a mean over a time.
The one that is named then takes nearly all of the other one as well, and its size is off by many standard errors, which
know of no other model. So the squared standard error of a named effect is the mean over both models of the squared
deviation from the stated size (Burnham and Anderson, Model Selection and Multimodel Inference, 2nd ed., section 4.3).
The larger model is fitted to all rows for its weight: the held-out rows help to decide, as for the names.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.selection.rivals import SECOND, relative_weight, rises_over
from diagnosis.inference.selection.stepwise import MAX_EFFECTS, extended

MOVED = 3.0
"""Standard errors by which a number must change for another size."""
MIN_RISE = -50.0
"""Smallest rise of the cost; it only prevents an overflow."""


@dataclass(frozen=True)
class OtherSize:
    """Change of the numbers of an effect beside a second one."""

    beside: str
    """Name of the second effect."""
    rise: float
    """Increase of the cost of all rows, with the penalties of the second effect."""
    changes: Mapping[str, float]
    """Changes of the numbers of the effect by the second one."""
    std: Mapping[str, float]
    """Standard errors of the numbers beside the second one."""

    @property
    def weight(self) -> float:
        """Weight of the larger model beside the one without the second effect."""
        relative = relative_weight(max(self.rise, MIN_RISE))
        return relative / (1.0 + relative)

    def wider(self, std: Mapping[str, float]) -> dict[str, float]:
        """Return the standard errors of the numbers over both models; `std` are those without the second effect."""
        beside = {name: np.hypot(self.std[name], self.changes[name]) for name in std}
        share = self.weight
        return {name: float(np.sqrt((1.0 - share) * std[name] ** 2 + share * beside[name] ** 2)) for name in std}


def other_size(
    evidence: Evidence, fit: HypothesisFit, effect: CandidateEffect, effects: Sequence[CandidateEffect]
) -> OtherSize | None:
    """Return the size of an effect beside the best second effect that changes it; None if there is none.

    Args:
        evidence: The observations.
        fit: The fit with the named effects.
        effect: One of them.
        effects: The effects that a second one may be.
    """
    if len(fit.hypothesis.effects) >= MAX_EFFECTS:
        return None
    values, std = fit.hypothesis.values(effect, fit.x), fit.std(effect)
    larger_fits = [
        larger
        for larger in extended(evidence, fit, effects)
        if np.isfinite([*larger.std(effect).values()]).all()
        and any(
            abs(value - values[name]) > MOVED * std[name]
            for name, value in larger.hypothesis.values(effect, larger.x).items()
        )
    ]
    rises = zip(rises_over(evidence, fit, larger_fits), larger_fits, strict=True)
    best = min(rises, key=lambda each: each[0], default=None)
    if best is None:
        return None
    rise, larger = best
    second = larger.hypothesis.added_to(fit.hypothesis)
    changes = {name: value - values[name] for name, value in larger.hypothesis.values(effect, larger.x).items()}
    return OtherSize(second.name, rise + SECOND, changes, larger.std(effect))

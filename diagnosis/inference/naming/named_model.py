"""The named model: which of the names that were selected stand by themselves."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fit import HypothesisFit
from diagnosis.inference.hypothesis import CandidateEffect
from diagnosis.inference.naming.transfer import Group, contradiction, supports
from diagnosis.inference.naming.verdict import SUBSTITUTE, NameEvidence, WithheldName, cancel, withheld
from diagnosis.inference.refusal import is_at_bound, needed
from diagnosis.inference.rivals import RivalComparison, compare_rivals
from diagnosis.inference.selection import Selection, without
from diagnosis.inference.unexplained.adequacy import Adequacy, adequacy, change_by
from diagnosis.inference.unexplained.survivors import survivors
from diagnosis.inference.unexplained.unlisted import advantage, with_forms


@dataclass(frozen=True)
class NamedModel:
    """A fit with the rivals of each of its names, and the test of its residuals."""

    fit: HypothesisFit
    comparisons: Sequence[RivalComparison]
    result: Adequacy


def standing(
    evidence: Evidence,
    selection: Selection,
    model: NamedModel,
    effects: Sequence[CandidateEffect],
    parts: Sequence[Group],
) -> tuple[NamedModel, tuple[WithheldName, ...]]:
    """Return the model with only those names that stand by themselves, and the names withheld.

    Names are withheld one at a time, the weakest first, since the others may stand without it.
    """
    nominal = selection.nominal
    withheld_names: list[WithheldName] = []
    while True:
        bases = [without(evidence, model.fit, comparison.effect) for comparison in model.comparisons]
        name_evidence = [
            _name_evidence(evidence, nominal, model, comparison, base, contradiction(each, base.cost - model.fit.cost))
            for comparison, base, each in zip(
                model.comparisons, bases, supports(evidence, model.fit, bases, parts), strict=True
            )
        ]
        failing = [
            (each, comparison)
            for each, comparison in zip(name_evidence, model.comparisons, strict=True)
            if withheld(each)
        ]
        if not failing:
            return model, tuple(withheld_names)
        # Effects that cancel each other imitate the same thing, so they go together.
        cancelling = [pair for pair in failing if pair[0].cancelled_by]
        going = cancelling or [min(failing, key=lambda pair: pair[0].rise)]
        withheld_names += [WithheldName(each.name, withheld(each)) for each, _ in going]
        fit = model.fit
        for _, comparison in going:
            fit = without(evidence, fit, comparison.effect)
        left = with_forms(evidence, nominal, fit, adequacy(evidence, fit))
        if left.has_cause and fit.hypothesis.effects:
            surviving = survivors(evidence, nominal, fit, left)
            substitutes = [effect for effect in fit.hypothesis.effects if effect not in surviving]
            withheld_names += [WithheldName(effect.name, SUBSTITUTE) for effect in substitutes]
            for effect in substitutes:
                fit = without(evidence, fit, effect)
        result = model.result if left.is_adequate else left
        comparisons = [
            compare_rivals(evidence, fit, effect, effects, pairs=selection.pairs, is_whole=not result.has_cause)
            for effect in fit.hypothesis.effects
        ]
        model = NamedModel(fit, comparisons, result)


def _cancelled_by(evidence: Evidence, nominal: HypothesisFit, fit: HypothesisFit, effect: CandidateEffect) -> str:
    """Return the name of another effect of a fit that undoes what this one does; empty if there is none."""
    others = [other for other in fit.hypothesis.effects if other != effect]
    if not others:
        return ""
    change = change_by(evidence, nominal, fit, effect)
    return next((other.name for other in others if cancel(change, change_by(evidence, nominal, fit, other))), "")


def _name_evidence(  # noqa: PLR0917 - all that is known of a name
    evidence: Evidence,
    nominal: HypothesisFit,
    model: NamedModel,
    comparison: RivalComparison,
    base: HypothesisFit,
    contradicted_by: str,
) -> NameEvidence:
    """Return what the data say of one name of a model, which leaves an unexplained structure or none.

    Beside such a structure a rival may win by taking over a part of it, so rivals count only without.
    """
    fit, effect, has_rest = model.fit, comparison.effect, not model.result.leaves_only_outliers
    heldout_rise = float((base.costs - fit.costs)[evidence.heldout].sum()) if evidence.heldout.any() else None
    rival = None if has_rest else next((rival for rival in comparison.rivals if not rival.refused), None)
    return NameEvidence(
        name=effect.name,
        rise=base.cost - fit.cost,
        needed=needed(effect),
        rise_of_prior=base.prior_cost - fit.prior_cost,
        heldout_rise=heldout_rise,
        is_at_bound=is_at_bound(fit, effect),
        contradicted_by=contradicted_by,
        cancelled_by=_cancelled_by(evidence, nominal, fit, effect),
        closest_rival=None if rival is None else (rival.effect.name, rival.worse),
        ahead=-np.inf if has_rest else advantage(evidence, base, fit),
        confidence=1.0 if has_rest else comparison.confidence,
    )

"""The named model: which of the names that were selected stand by themselves."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.gain import Gain, gain_of
from diagnosis.inference.naming.transfer import Group, contradiction, supports
from diagnosis.inference.naming.verdict import SUBSTITUTE, NameEvidence, WithheldName, margin, withheld
from diagnosis.inference.selection.refusal import heldout_falls, is_at_bound, is_far_below_a_row, is_of_noise, needed
from diagnosis.inference.selection.removal import cancelled_by, without
from diagnosis.inference.selection.rivals import RivalComparison, compare_rivals, with_random_drift
from diagnosis.inference.selection.stepwise import Selection
from diagnosis.inference.unexplained.adequacy import Adequacy, adequacy
from diagnosis.inference.unexplained.drift.random_drift import rise_with_drift
from diagnosis.inference.unexplained.retained_effects import retained_effects
from diagnosis.inference.unexplained.scatter import with_scatter
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
    *,
    measured: Evidence,
) -> tuple[NamedModel, tuple[WithheldName, ...]]:
    """Return the model with only those names that stand by themselves, and the names withheld.

    Names are withheld one at a time, the weakest first, since the others may stand without it.

    Args:
        evidence: The observations that the effects are fitted to.
        selection: The selection.
        model: The model with all names.
        effects: All candidates.
        parts: Groups of samples that are left out in turn.
        measured: The observations as they were measured, on which gains are computed.
    """
    model = _beside_drift(evidence, model)
    withheld_names: list[WithheldName] = []
    while failing := _failing(evidence, selection.nominal, model, parts, measured):
        # Effects that cancel each other imitate the same thing, so they go together.
        cancelling = [each for each in failing if each.cancelled_by]
        going = cancelling or [min(failing, key=lambda each: each.rise)]
        withheld_names += [WithheldName(each.name, withheld(each)) for each in going]
        names = {each.name for each in going}
        removed = [effect for effect in model.fit.hypothesis.effects if effect.name in names]
        fit, result, substitutes = _remaining(evidence, selection.nominal, model, removed)
        withheld_names += [WithheldName(effect.name, SUBSTITUTE) for effect in substitutes]
        comparisons = [
            compare_rivals(evidence, fit, effect, effects, pairs=selection.pairs, is_whole=not result.has_cause)
            for effect in fit.hypothesis.effects
        ]
        model = _beside_drift(evidence, NamedModel(fit, comparisons, result))
    return model, tuple(withheld_names)


def _failing(
    evidence: Evidence, nominal: HypothesisFit, model: NamedModel, parts: Sequence[Group], measured: Evidence
) -> list[NameEvidence]:
    """Return the evidence for those names of a model that do not stand by themselves."""
    bases = [without(evidence, model.fit, comparison.effect) for comparison in model.comparisons]
    support = supports(evidence, model.fit, bases, parts)
    name_evidence = [
        replace(
            _name_evidence(evidence, nominal, model, comparison, base),
            contradicted_by=contradiction(each, base.cost - model.fit.cost),
            gain_at_most=gained.high if gained else None,
            gain_at_least=gained.low if gained else None,
        )
        for comparison, base, each in zip(model.comparisons, bases, support, strict=True)
        for gained in [_gain(measured, base, model.fit, comparison.effect)]
    ]
    return [each for each in name_evidence if withheld(each)]


def _remaining(
    evidence: Evidence, nominal: HypothesisFit, model: NamedModel, removed: Sequence[CandidateEffect]
) -> tuple[HypothesisFit, Adequacy, list[CandidateEffect]]:
    """Return the fit without some effects, the structure that it leaves, and the effects that go with them.

    These are substitutes for a structure that is unexplained without the removed effects.
    """
    fit = model.fit
    for effect in removed:
        fit = without(evidence, fit, effect)
    left = with_scatter(evidence, fit, with_forms(evidence, nominal, fit, adequacy(evidence, fit)))
    substitutes: list[CandidateEffect] = []
    if left.has_cause and fit.hypothesis.effects:
        retained = retained_effects(evidence, nominal, fit, left)
        substitutes = [effect for effect in fit.hypothesis.effects if effect not in retained]
        for effect in substitutes:
            fit = without(evidence, fit, effect)
    return fit, model.result if left.is_adequate else left, substitutes


def _beside_drift(evidence: Evidence, model: NamedModel) -> NamedModel:
    """Return the model with a random drift of the ranges as a further rival of each name."""
    comparisons = [
        with_random_drift(each, rise_with_drift(evidence, model.fit, each.effect)) for each in model.comparisons
    ]
    return replace(model, comparisons=comparisons)


def _gain(measured: Evidence, base: HypothesisFit, fit: HypothesisFit, effect: CandidateEffect) -> Gain | None:
    """Return the gain by an effect on the held-out rows, with which a fit goes beyond a base.

    It is None if no rows are held out, and for an effect of the noise, which predicts no reading.
    """
    if is_of_noise(fit, effect):
        return None
    readings = measured.as_measured()
    both = [readings.predicted([each.robot]).moved(each.local_change).mean[0] for each in (base, fit)]
    return gain_of(readings, np.stack(both))


def _name_evidence(
    evidence: Evidence,
    nominal: HypothesisFit,
    model: NamedModel,
    comparison: RivalComparison,
    base: HypothesisFit,
) -> NameEvidence:
    """Return what the fits say of one name of a model, which leaves an unexplained structure or none.

    Beside such a structure a rival may win by taking over a part of it, so the closest rival counts only without. The
    confidence counts in any case: nobody believes a name at 1 %.
    """
    fit, effect, has_rest = model.fit, comparison.effect, not model.result.leaves_only_outliers
    heldout_rise = float(heldout_falls(evidence, base, fit, effect).sum()) if evidence.heldout.any() else None
    rival = None if has_rest else comparison.closest
    return NameEvidence(
        name=effect.name,
        rise=base.cost - fit.cost,
        needed=needed(effect),
        rise_of_prior=base.prior_cost - fit.prior_cost,
        heldout_rise=heldout_rise,
        is_at_bound=is_at_bound(fit, effect),
        contradicted_by="",
        cancelled_by=cancelled_by(evidence, nominal, fit, effect),
        closest_rival=rival,
        ahead=-np.inf if has_rest else advantage(evidence, base, fit),
        confidence=comparison.confidence,
        is_far_below_a_row=is_far_below_a_row(fit, effect),
        # The statement, which the noise goes beyond, is the worst that is possible already.
        margin=margin(effect),
    )

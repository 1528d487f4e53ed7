"""Discovery: a law for what the listed effects leave unexplained, or else a smooth curve, in a slot of the simulator.

A law describes; it is no name. The verdict stays as it is, and the law extends the model. It is accepted if no draw of
signs does as well (`search`), if the fitted rows show it clearly, and if all named effects are still needed beside it.
Held-out rows choose nothing; they can only refuse the best form. A form with few numbers competes with smooth curves
over each covariate, with a penalty for each number; if none is better, the best curve is the law.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import log

import numpy as np

from configs.effects.registry import EFFECTS
from diagnosis.diagnose import Diagnosis
from diagnosis.discovery.active_samples import ActiveSamples
from diagnosis.discovery.form import LawForm
from diagnosis.discovery.grammar import CURVE, can_have_law, forms, smooth
from diagnosis.discovery.law import DiscoveredLaw, Discovery
from diagnosis.discovery.place import LawPlace, values_of
from diagnosis.discovery.places import places
from diagnosis.discovery.search import FittedLaw, fitted, null_start, scan_forms
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.rounding import with_shared_rounding
from diagnosis.inference.fitting.fit import HypothesisFit, fits
from diagnosis.inference.gain import gain
from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.inference.naming.seen_range import SeenRange, conditions, predicted_readings, rows_of, seen_ranges
from diagnosis.inference.naming.verdict import CaseVerdict
from diagnosis.inference.selection.refusal import is_at_bound
from diagnosis.inference.selection.removal import without
from diagnosis.inference.selection.rivals import AS_GOOD
from diagnosis.inference.unexplained.adequacy import adequacy
from diagnosis.inference.unexplained.retained_effects import NEEDED
from diagnosis.measured.measurement import Measurement
from symolo.core.arrays import Array

OPEN = (CaseVerdict.UNEXPLAINED, CaseVerdict.NAMED_IN_PART, CaseVerdict.UNDECIDED)
"""Conclusions that leave something open, so that a law is looked for."""
MAX_CHANCE = 0.01
"""Share of draws of signs in which chance may do as well as the best form: one of 199 at most."""
MIN_SCORE = 15.0
"""Smallest fall of the cost, less the penalties for numbers and forms."""
MAX_HELDOUT_RISE = 2.0
"""Largest rise of the cost of the held-out rows. Few held-out rows may hardly show a law."""
MIN_ROWS = 12
"""Smallest number of samples of the fit with which a law is looked for."""


def with_law(diagnosis: Diagnosis, *, always: bool = False) -> Diagnosis:
    """Return a diagnosis with the search for a law; names and conclusion stay.

    Args:
        diagnosis: The diagnosis.
        always: Whether a law is looked for even if the diagnosis leaves nothing open, to count false alarms.
    """
    if diagnosis.conclusion not in OPEN and not always:
        return replace(
            diagnosis, discovery=Discovery(None, "the diagnosis leaves nothing open, so that none is needed")
        )
    best, reason, scan = _best(diagnosis)
    if best is None:
        return replace(diagnosis, discovery=Discovery(None, reason))
    in_hand = EFFECTS.files.get(best.form.name)
    if in_hand is not None and in_hand.member not in {each.kind for each in diagnosis.fit.hypothesis.effects}:
        reason = f"the best form, {best.form.words}, is that of {in_hand.path.name}, which is given and is not named"
        return replace(diagnosis, discovery=Discovery(None, reason))
    evidence, measured, nominal = diagnosis.evidence, diagnosis.measured, diagnosis.selection.nominal
    law, fit = _law(diagnosis, best, scan)
    return replace(
        diagnosis,
        fit=fit,
        named=tuple(NamedEffect.from_comparison(evidence, nominal, fit, each.comparison) for each in diagnosis.named),
        gain=gain(measured, diagnosis.nominal, fit.robot, (0.0, fit.local_change)),
        discovery=Discovery(law, ""),
    )


@dataclass(frozen=True)
class LawSearch:
    """What a law was chosen from."""

    chance: float
    forms_tried: int
    rivals: tuple[tuple[str, float], ...] = ()
    """Other forms that do nearly as well, in words, and by how much their score is lower."""


def _best(diagnosis: Diagnosis) -> tuple[FittedLaw | None, str, LawSearch]:
    """Return the best form that is accepted, why there is none, and what it was chosen from."""
    measurement, evidence, fit = diagnosis.measurement, diagnosis.evidence, diagnosis.fit
    where = () if measurement.cases else places(measurement.kind, evidence, fit.robot.motor)
    if not where:
        reason = "laws are looked for in single benches, step logs, scans and drives of the case format"
        return None, reason, LawSearch(1.0, 0)
    if fit.is_of_whole_runs:
        return None, "the numbers are fitted to the ends of whole runs, and not to rows", LawSearch(1.0, 0)
    if np.count_nonzero(evidence.fit) < MIN_ROWS:
        return None, f"fewer than {MIN_ROWS} samples to fit", LawSearch(1.0, 0)
    materials = _materials(measurement)
    tried = [form for place in where for form in forms(place, materials)]
    scan = scan_forms(evidence, fit, tried)
    # Each form was chosen from many, of which the best one fits by chance.
    choice_penalty = 2.0 * log(max(1, len(tried)))
    laws = fitted(evidence, fit, scan.promising)
    curves = fitted(evidence, fit, [(form, [null_start(fit, form)]) for form in _curves(where)])
    every = [*(replace(each, score=each.score - choice_penalty) for each in laws), *curves]
    every.sort(key=lambda each: -each.score)
    reasons = [_refusal(evidence, fit, each, scan.chance) for each in every]
    accepted = [each for each, reason in zip(every, reasons, strict=True) if not reason]
    if not accepted:
        reason = "no covariate of a slot varies"
        if every:
            reason = f"the best form, {every[0].form.words}, is refused, since {reasons[0]}"
        return None, reason, LawSearch(scan.chance, len(tried))
    best, *others = accepted
    if evidence.heldout.any() and best.heldout_fall < -MAX_HELDOUT_RISE:
        rise = f"since the cost of the held-out rows rises by {-best.heldout_fall:.1f}"
        return None, f"the best form, {best.form.words}, is refused, {rise}", LawSearch(scan.chance, len(tried))
    rivals = tuple((each.form.words, best.score - each.score) for each in others if best.score - each.score < AS_GOOD)
    return best, "", LawSearch(scan.chance, len(tried), rivals)


def _curves(where: Sequence[LawPlace]) -> list[LawForm]:
    """Return a smooth curve over each covariate."""
    return [
        curve
        for place in where
        for covariate in place.covariates.values()
        if not (place.is_factor or covariate.is_of_path)
        and can_have_law(covariate)
        and (curve := smooth(place, covariate)) is not None
    ]


def _refusal(evidence: Evidence, before: HypothesisFit, tried: FittedLaw, chance: float) -> str:
    """Return why a form is no law; empty if it is one."""
    if chance > MAX_CHANCE:
        return f"some form does as well in {100.0 * chance:.2g} % of the draws with random signs of the residuals"
    if tried.score < MIN_SCORE:
        return f"the cost falls by {tried.score:.1f} less penalties for its numbers, and {MIN_SCORE:.0f} is needed"
    if is_at_bound(tried.fit, tried.form.candidate):
        return "a number lies at its bound"
    for effect in before.hypothesis.effects:
        if without(evidence, tried.fit, effect).cost - tried.fit.cost < NEEDED:
            return f"{effect.name} would not be needed beside it"
    return ""


def _law(diagnosis: Diagnosis, best: FittedLaw, search: LawSearch) -> tuple[DiscoveredLaw, HypothesisFit]:
    """Return the law of the best form, whose file has the fitted values as its start, and the fit with it."""
    evidence, before = diagnosis.evidence, diagnosis.fit
    numbers = best.fit.hypothesis.values(best.form.candidate, best.fit.x)
    form = best.form.starting_at(numbers).named_beside(EFFECTS.by_name())
    hypothesis = before.hypothesis.with_effect(form.candidate)
    x = best.fit.x.copy()
    x[hypothesis.parameters(form.candidate)] = [c.coordinate(numbers[c.name]) for c in form.candidate.coordinates]
    (fit,) = fits(evidence, [(hypothesis, hypothesis.clipped(x))])
    rest = adequacy(evidence, fit)
    fit = with_shared_rounding(evidence, fit)
    values = hypothesis.values(form.candidate, fit.x)
    law = DiscoveredLaw(
        form=form,
        without=before,
        values=dict(values),
        std=form.with_width_of_jump(values, fit.std(form.candidate)),
        ranges=tuple(_ranges(diagnosis, fit, form)),
        active=ActiveSamples.from_evidence(
            evidence, form.covariates, rows_of(evidence, diagnosis.selection.nominal, fit, form.candidate)
        ),
        is_curve=form.shape == CURVE,
        fall=before.cost - fit.cost,
        heldout_fall=float((before.costs - fit.costs)[evidence.heldout].sum()) if evidence.heldout.any() else None,
        gain=gain(diagnosis.measured, before.robot, fit.robot, (before.local_change, fit.local_change)),
        chance=search.chance,
        forms_tried=search.forms_tried,
        rivals=search.rivals,
        left=None if rest.is_adequate else rest.worst,
        source=diagnosis.measurement.name,
    )
    return law, fit


def _ranges(diagnosis: Diagnosis, fit: HypothesisFit, form: LawForm) -> Iterator[SeenRange]:
    """Yield the range of each condition; that of the law's own ones has all rows, since any of them shows the law."""
    evidence = diagnosis.evidence
    usable, data = evidence.fit | evidence.heldout, dict[str, list[Array]]()
    readings = predicted_readings(evidence, fit)
    for observed, place in zip(evidence.observed, evidence.places, strict=True):
        # The time of a session is no condition, but the law may depend on it.
        covariates = values_of(observed) | dict(conditions(observed, readings))
        for name, values in covariates.items():
            data.setdefault(name, []).append(values[usable[place] & np.isfinite(values)])
    for name in form.covariates:
        values = np.concatenate(data[name])
        yield SeenRange(name, float(values.min()), float(values.max()))
    for seen in seen_ranges(evidence, diagnosis.selection.nominal, fit, form.candidate):
        if seen.covariate not in form.covariates:
            yield seen


def _materials(measurement: Measurement) -> tuple[str, ...]:
    names = {
        value
        for trial in measurement.trials
        for label in trial.labels
        if label.name == "material"
        for value in label.values
    }
    return tuple(sorted(names - {""}))

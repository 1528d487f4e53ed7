"""The verdict in plain sentences, the same on a terminal and on the page."""

from collections.abc import Iterator, Mapping, Sequence
from math import ceil, inf, log10

import numpy as np

from configs.effects.base import Effect
from diagnosis.diagnose import Diagnosis
from diagnosis.inference.evidence.stuck_rows import stuck_rows
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.likelihood import LEVELS
from diagnosis.inference.fitting.profile import Interval
from diagnosis.inference.gain import Gain
from diagnosis.inference.log_score import LogScoreChange
from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.inference.naming.verdict import DOUBT, NEARLY, NOISY, CaseVerdict
from diagnosis.inference.selection.refusal import needed
from diagnosis.inference.unexplained.adequacy import CLUSTER, LEVEL, Structure
from diagnosis.inference.unexplained.bases import RUNS_OF_ROWS
from diagnosis.inference.unexplained.drift.random_drift import RandomDrift
from diagnosis.inference.unexplained.forms import GAIN
from diagnosis.inference.unexplained.scatter import SCATTER
from diagnosis.inference.unexplained.uneven_noise import UNEVEN
from diagnosis.measured.measurement import CaseKind
from diagnosis.predictors.turning_loads import TURNING
from diagnosis.report.report_data import Ablation, ReportData
from diagnosis.report.sentences.file_numbers import label
from diagnosis.report.sentences.parameters_off import parameters_off
from diagnosis.report.sentences.quantities import (
    along,
    confidence,
    cost,
    gain_text,
    meaning,
    percent,
    quantity_words,
    with_error,
)

MIN_BENT = 4.0
"""Deviation in tolerances from which a nominal parameter is mentioned."""
NO_ERROR = 0.01
"""Error on held-out rows, in sigmas, below which they say nothing: noise alone is far larger."""
_MAX_VOLTAGES = 3
"""Voltages at standstill that the headline lists; more are counted."""
_MORE_LIKELY_THAN_NOT = 0.5
_NEARLY_AS_WELL = 12.0
"""Rise of the cost up to which something else has a twentieth of the weight of a name."""
_MIN_SURE = 0.9
"""Confidence of an effect without rivals, below which chance is mentioned."""


def headline(diagnosis: Diagnosis) -> str:
    """Return what is wrong, in one sentence."""
    names = _labels(diagnosis)
    structure = diagnosis.unexplained
    if structure is None:
        if names and any(named.comparison.confidence < _MORE_LIKELY_THAN_NOT for named in diagnosis.named):
            fit = "fits" if len(names) == 1 else "fit"
            return f"The real robot differs from the nominal one. {listed(names)} {fit} best, but this is not certain."
        if names:
            return f"The real robot differs from the nominal one by {listed(names)}."
        if diagnosis.conclusion is CaseVerdict.UNDECIDED:
            text = f"These data neither confirm the nominal simulation nor name what differs: {_open(diagnosis)}."
        elif parameters_off(diagnosis.fit):
            text = "No effect is needed to explain these data, but numbers of the nominal robot seem to be wrong."
        else:
            text = "The nominal simulation explains these data, within the tolerances of its parameters."
        stuck = _stuck(diagnosis)
        return f"{stuck}; apart from that, {text[0].lower()}{text[1:]}" if stuck else text
    if diagnosis.adequacy.leaves_only_outliers:
        rows = f"successive rows of {structure.observed} are far off together, as the logger alone may cause it"
        if names:
            return f"The real robot differs from the nominal one by {listed(names)}; in addition, {rows}."
        return f"No effect is named, but {rows}."
    return _headline_of_unexplained(diagnosis, structure, names)


def _headline_of_unexplained(diagnosis: Diagnosis, structure: Structure, names: Sequence[str]) -> str:
    """Return that residuals have structure; if a warning about the log names a likely cause, that it is one."""
    what = f"{structure.channel} depends on {along(structure.covariate)}"
    if structure.what.startswith(SCATTER):
        by = "the noise that nominal.yaml states" if diagnosis.measurement.nominal else "the stated noise"
        what = f"{structure.channel} has a {structure.what.replace('the stated noise', by)}"
    if structure.what.startswith(UNEVEN):
        what = f"{structure.channel} has {_of_noise(structure)}"
    where = f"{what}, and no known effect explains this"
    if diagnosis.measurement.checks:
        where = f"{what}; the warning about the log names a likely cause"
        if not names:
            return f"The simulation and these data do not fit together: {where}. Correct that first."
    if not names:
        return f"The simulation is wrong in a way that has no name here: {where}."
    return f"The real robot differs from the nominal one by {listed(names)}; in addition, {where}."


def _labels(diagnosis: Diagnosis) -> list[str]:
    """Return the names, with a remark where the file of an effect states other numbers."""
    remarks = {named.effect.name: label(named) for named in (diagnosis.named if diagnosis.names else ())}
    return [remarks.get(name, name) for name in diagnosis.names]


def no_effect(diagnosis: Diagnosis) -> str:
    """Return why no law is named, in one sentence."""
    if diagnosis.names:
        return "No other effect is named."
    why = {
        CaseVerdict.EXPLAINED: "none is needed to explain these data",
        CaseVerdict.UNDECIDED: "something may differ, but these data do not suffice to name it",
    }.get(diagnosis.conclusion, "no known effect explains these data")
    return f"No effect is named: {why}."


def _stuck(diagnosis: Diagnosis) -> str:
    """Return that a real motor stands still where the nominal one turns, as a clause; empty if none does."""
    if diagnosis.measurement.kind is not CaseKind.MOTOR_STEADY:
        return ""
    volts = sorted({row.voltage_V for row in stuck_rows(diagnosis.measurement, diagnosis.nominal)})
    if not volts:
        return ""
    several = f"{len(volts)} voltages from {volts[0]:g} to {volts[-1]:g} V"
    where = several if len(volts) > _MAX_VOLTAGES else listed([f"{voltage_V:g} V" for voltage_V in volts])
    return f"The real motor stands still at {where}, where the nominal one turns"


def _open(diagnosis: Diagnosis) -> str:
    """Return what suggests that something differs, as a clause."""
    parts = [f"{each.name} was considered, but {each.reason}" for each in diagnosis.withheld]
    parts += [
        f"{name} would lower the cost by {fall:.1f}, where a name needs {fall * times:.0f}"
        for name, fall, times in hints(diagnosis)
    ]
    parts += [
        f"{entry.effect.name} would lower the cost by {entry.drop:.1f}, but {entry.reason}"
        for entry in diagnosis.selection.refused
        if entry.drop >= needed(entry.effect)
    ]
    first = next(iter(diagnosis.adequacy.structures), None)
    if first is not None and first.p < DOUBT:
        parts.append(f"the residuals of {first.observed} may depend on {along(first.covariate)} (p = {first.p:.2g})")
    parts += [
        f"{name} scatters {'at least ' if level >= LEVELS[1] else ''}{level:.1f} times as much as stated"
        for name, level in diagnosis.scatters
        if level >= NOISY
    ]
    return "; ".join(parts)


def listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def effect_sentences(diagnosis: Diagnosis) -> list[str]:
    """Return the name, the parameters, the meaning and the possible causes of each effect."""
    sentences = [_sentence(n.effect.name, n.effect.kind, n.values, n.std) for n in diagnosis.named]
    if diagnosis.random_drift is not None:
        sentences.append(random_drift_sentence(diagnosis.random_drift))
    return sentences


def random_drift_sentence(random_drift: RandomDrift) -> str:
    """Return what is known of the slow error of a range sensor."""
    effect = random_drift.effect
    sentence = _sentence(effect.name, type(effect), effect.model_dump(), random_drift.std)
    return f"{sentence} It is random and in no prediction, so the errors on held-out rows and the residuals include it."


def _sentence(label: str, kind: type[Effect], values: Mapping[str, float], std: Mapping[str, float]) -> str:
    parameters = []
    for name, value in values.items():
        unit = kind.parameters()[name].unit
        parameters.append(f"{name} = {with_error(value, std[name])}{'' if unit == '1' else f' {unit}'}")
    return f"{label}: {', '.join(parameters)}. {meaning(kind)} Possible causes: {kind.cause}."


def certainty(named: NamedEffect) -> str:
    """Return how sure the name is, and compared with which other effects."""
    comparison = named.comparison
    sure = confidence(comparison.confidence)
    if comparison.ambiguous_with:
        return f"{sure}; these data cannot distinguish it from {listed(comparison.ambiguous_with)}"
    if comparison.confidence < _MIN_SURE:
        if not comparison.is_whole:
            return f"{sure}; what stays unexplained, or scatters more than stated, may have the same cause"
        other, rise = min(comparison.others, key=lambda each: each[1], default=("", inf))
        if rise < _NEARLY_AS_WELL and all(rise <= rival.worse for rival in comparison.rivals):
            return f"{sure}; {other} would explain the data nearly as well"
        if shares := list(_shares_of_doubt(named)):
            return f"{sure}; the rest is shared by {listed([*shares, 'causes that are in no list'])}"
    if comparison.rivals:
        rival = comparison.rivals[0]
        worse = f"explains the data worse: the cost is higher by {cost(rival.worse)}"
        return f"{sure}; the closest alternative, {rival.effect.name}, {worse}"
    if comparison.confidence < _MIN_SURE:
        return f"{sure}; no other effect comes close, but the cost falls little more than by chance"
    return f"{sure}; no other effect comes close"


def _shares_of_doubt(named: NamedEffect) -> Iterator[str]:
    """Yield what has a notable weight beside a name, the largest first."""
    comparison = named.comparison
    shares = [(comparison.by_chance, "chance (the cost falls little more than a name needs)")]
    if comparison.rivals:
        rival = comparison.rivals[0]
        text = f"the closest alternative ({rival.effect.name}, with which the cost is higher by {cost(rival.worse)})"
        shares.append((rival.worse, text))
    shares += [(rise, name.rstrip(",")) for name, rise in comparison.others[:1]]
    yield from (text for rise, text in sorted(shares) if rise < _NEARLY_AS_WELL)


def to_measure(named: NamedEffect) -> Iterator[tuple[str, str]]:
    """Yield an ambiguous effect and its alternatives, each with the data in which it shows."""
    ambiguous = named.comparison.ambiguous_with
    if ambiguous:
        alternatives = [rival.effect for rival in named.comparison.rivals if rival.effect.name in ambiguous]
        for effect in (named.effect, *alternatives):
            yield effect.name, effect.kind.excitation


def without_effect(ablation: Ablation, fit: HypothesisFit) -> str:
    """Return how the model `fit` becomes worse without an effect, as a clause."""
    text = f"the cost rises by {cost(ablation.cost_rise)}"
    if deviations := _bent_text(ablation.fit, besides=fit):
        text += f", and parameters leave their tolerances ({deviations})"
    if ablation.gain is None or ablation.effect_gain is None or ablation.log_score is None:
        return text
    if says_nothing(ablation.gain):
        return f"{text}; the held-out rows say nothing about it"
    if ablation.is_of_noise:
        return f"{text}; {_of_log_score(ablation.log_score)}"
    return (
        f"{text}; on the held-out rows, the fitted model without it gains {gain_text(ablation.gain)} over the nominal "
        f"robot, and adding the effect to it {_gains(ablation.effect_gain)}"
    )


def _of_log_score(change: LogScoreChange) -> str:
    """Return what an effect of the noise does to the likelihood of held-out readings, as a clause."""
    size, direction = abs(change.value), "raises" if change.value >= 0.0 else "lowers"
    ends = "too few rows for an interval"
    if change.high > change.low:
        ends = f"95 % interval of the change {change.low:.2g} to {change.high:.2g}"
    return f"the effect {direction} the log-likelihood of a held-out reading by {size:.2g} on average ({ends})"


def reach(intervals: Sequence[Interval]) -> str:
    """Return the widest profile interval of a parameter in words."""
    widest = intervals[-1]
    # Enough digits to show the width of an interval that is narrow compared with its ends.
    digits = max(3, 2 + ceil(log10(max(abs(widest.low), abs(widest.high)) / (widest.high - widest.low))))
    ends = f"{widest.low:.{digits}g} to {widest.high:.{digits}g}"
    return f"{percent(widest.level)} profile interval {ends}" + (", open at a bound" if widest.is_open else "")


def nothing_left(diagnosis: Diagnosis, *, numbers_are_off: bool = False) -> str:
    """Return that no structure in the residuals is certain, and which one is most likely, in one or two sentences."""
    nothing = "Beside these numbers, nothing" if numbers_are_off else "Nothing"
    first = next(iter(diagnosis.adequacy.structures), None)
    if first is None or first.p >= DOUBT:
        smallest = f" (smallest p-value of all tests: {first.p:.2g})" if first else ""
        return f"{nothing}: no covariate shows more structure in the residuals than is expected by chance{smallest}."
    return (
        f"{nothing} is certain. The residuals of {first.observed} may depend on {along(first.covariate)} "
        f"(p = {first.p:.2g}), but structure counts as such only if p is below {LEVEL:g}."
    )


def unexplained_sentence(structure: Structure) -> str:
    """Return what remains unexplained and where, in one sentence."""
    chance = "less than 1e-12" if structure.p < 1e-12 else f"{structure.p:.2g}"
    if structure.what.startswith(SCATTER):
        return (
            f"The residuals of {structure.observed} have a {structure.what}, and no covariate explains it. The "
            f"probability of this by chance is {chance}, if the noise is stated correctly."
        )
    if structure.what.startswith(UNEVEN):
        return (
            f"The residuals of {structure.observed} have {_of_noise(structure)}; the probability of this by chance is "
            f"{chance}."
        )
    words, _ = quantity_words(structure.covariate)
    shape, _, sign = structure.what.partition(", ")
    shape = {
        CLUSTER: f"outliers at neighbouring values of {words}",
        RUNS_OF_ROWS: "successive rows that are off together",
        "trend": f"a smooth curve over {words}",
        "category": f"another mean for each {words}",
        "turn": f"an oscillation with {words}",
        "place": "an error that depends on the place",
        "outline": f"an error that depends on the {words}",
        "event": f"a shift at each {words}",
        "step": f"a step at one value of {words}",
        "kink": f"a straight line that begins at one value of {words}",
        GAIN: f"a gain that changes with {words}",
        "bump": f"a bump around one value of {words}",
    }.get(shape, f"a {shape} over {words}") + (f", {sign}" if sign else "")
    where = along(structure.covariate)
    if structure.covariate == TURNING:
        where, shape = f"{where}, the rate of turning", f"as from a {structure.what}"
    return (
        f"The residuals of {structure.observed} have structure along {where} ({shape}). Its root mean square is "
        f"{structure.size:.2g} standard deviations of the noise, and the probability of it by chance is {chance}."
    )


def _of_noise(structure: Structure) -> str:
    """Return where the noise is larger, with the covariate in words."""
    return structure.what.replace(structure.covariate, quantity_words(structure.covariate)[0])


def hints(diagnosis: Diagnosis) -> Iterator[tuple[str, float, float]]:
    """Yield effects that are too weak to be named: name, fall of the cost, and the factor of rows that would decide.

    An effect that was tried several times counts with the largest fall.
    """
    entries = sorted(diagnosis.selection.refused, key=lambda entry: -entry.drop)
    largest = {entry.effect.name: entry for entry in reversed(entries)}
    for entry in diagnosis.selection.refused:
        threshold = needed(entry.effect)
        if entry is largest[entry.effect.name] and NEARLY <= entry.drop < threshold:
            yield entry.effect.name, entry.drop, threshold / entry.drop


def _bent_text(fit: HypothesisFit, besides: HypothesisFit | None = None) -> str:
    """Return, for example, `track_m by 5 tolerances`, the furthest parameter first; empty if none is bent.

    Args:
        fit: The fit with these parameters.
        besides: Another fit, whose own bent parameters are left out.
    """
    known = {name for name, _ in _bent(besides)} if besides is not None else set()
    bent = [(name, deviation) for name, deviation in _bent(fit) if name not in known]
    names = ", ".join(f"{name} by {tolerances:.0f}" for name, tolerances in sorted(bent, key=lambda item: -item[1]))
    return f"{names} tolerances" if names else ""


def _bent(fit: HypothesisFit) -> list[tuple[str, float]]:
    deviations = zip(fit.hypothesis.nuisances, np.abs(fit.hypothesis.prior(fit.x)).tolist(), strict=True)
    return [(nuisance.name, deviation) for nuisance, deviation in deviations if deviation >= MIN_BENT]


def _gains(gain: Gain) -> str:
    """Return what a gain is, as a clause without its subject; a gain below zero is a larger error."""
    if gain.is_unchanged:
        return "changes nothing on the held-out rows"
    if gain.value >= 0.0:
        return f"gains {gain_text(gain)}"
    low, high = percent(gain.low), percent(gain.high)
    ends = f"95 % interval of the gain {low} to {high}" if gain.high > gain.low else "too few rows for an interval"
    return f"makes the error on the held-out rows {percent(-gain.value)} larger ({ends})"


def says_nothing(gain: Gain) -> bool:
    """Return whether the first model of a gain predicts the held-out rows so well that no other could be better."""
    return gain.before < NO_ERROR


def gain_sentences(data: ReportData) -> list[str]:
    """Return the gain on held-out rows, and the gain of calibration alone."""
    diagnosis = data.diagnosis
    if diagnosis.gain is None or diagnosis.calibrated is None:
        return ["No rows are held out, so it is not known how well the model predicts data that were not fitted."]
    if says_nothing(diagnosis.gain):
        text = "The held-out rows say nothing: the nominal robot predicts them to within a hundredth of the noise, as "
        text += "it does where nothing moves. They neither confirm a name nor refute it; hold out rows with motion."
        return [text]
    calibration = f"Fitting the nominal parameters alone, without any effect, {_gains(diagnosis.calibrated)}"
    if deviations := _bent_text(diagnosis.selection.nominal):
        calibration += f", but parameters leave their tolerances ({deviations})"
    if not diagnosis.fitted_effects:
        is_noise = diagnosis.conclusion is CaseVerdict.EXPLAINED and diagnosis.calibrated.value < 0.0
        why = ": where nothing is wrong, such a fit only follows the noise of the rows to which it is fitted"
        return [f"{calibration}{why if is_noise else ''}."]
    calibrated, before, after = diagnosis.calibrated.after, diagnosis.gain.before, diagnosis.gain.after
    error = f"the error {'falls' if after <= before else 'rises'} from {before:.3g} to {after:.3g} sigma"
    names = listed([each.effect.name for each in diagnosis.fitted_effects])
    if all(ablation.is_of_noise for ablation in data.ablations) and len(data.ablations) == len(
        diagnosis.fitted_effects
    ):
        change = f"What {names} changes is the scatter of the readings, which this error does not show."
    else:
        share = abs(1.0 - after / calibrated) if calibrated > 0.0 else 0.0
        change = f"With {names}, the error is {100.0 * share:.0f} % {'lower' if after < calibrated else 'higher'} than "
        change += "after this calibration alone."
    return [f"On the held-out rows {error}: a gain of {gain_text(diagnosis.gain)}.", f"{calibration}. {change}"]

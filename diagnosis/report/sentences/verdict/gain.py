"""What the effects gain on held-out rows, all together and each of them, in sentences."""

import numpy as np

from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.gain import Gain
from diagnosis.inference.log_score import LogScoreChange
from diagnosis.inference.naming.verdict import CaseVerdict
from diagnosis.report.report_data import Ablation, ReportData
from diagnosis.report.sentences.quantities import cost, gain_text, listed, percent

MIN_DEVIATION = 4.0
"""Deviation in tolerances from which a nominal parameter is mentioned."""
NO_ERROR = 0.01
"""Error on held-out rows, in sigmas, below which they say nothing: noise alone is far larger."""


def gain_sentences(data: ReportData) -> list[str]:
    """Return the gain on held-out rows, and the gain of calibration alone."""
    diagnosis = data.diagnosis
    if diagnosis.gain is None or diagnosis.calibrated is None:
        return ["No rows are held out, so it is not known how well the model predicts data that were not fitted."]
    if says_nothing(diagnosis.gain):
        text = "The held-out rows say nothing: the nominal robot predicts them to within a hundredth of the noise, as "
        text += "it does where nothing moves. They neither confirm a name nor refute it; hold out rows with motion."
        return [text]
    calibration = f"Fitting the nominal parameters alone, without any effect, {_gain_clause(diagnosis.calibrated)}"
    if deviations := _deviations_text(diagnosis.selection.nominal):
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


def without_effect(ablation: Ablation, fit: HypothesisFit) -> str:
    """Return how the model `fit` becomes worse without an effect, as a clause."""
    text = f"the cost rises by {cost(ablation.cost_rise)}"
    if deviations := _deviations_text(ablation.fit, besides=fit):
        text += f", and parameters leave their tolerances ({deviations})"
    if ablation.gain is None or ablation.effect_gain is None or ablation.log_score is None:
        return text
    if says_nothing(ablation.gain):
        return f"{text}; the held-out rows say nothing about it"
    if ablation.is_of_noise:
        return f"{text}; {_log_score_clause(ablation.log_score)}"
    return (
        f"{text}; on the held-out rows, the fitted model without it gains {gain_text(ablation.gain)} over the nominal "
        f"robot, and adding the effect to it {_gain_clause(ablation.effect_gain)}"
    )


def says_nothing(gain: Gain) -> bool:
    """Return whether the first model of a gain predicts the held-out rows so well that no other could be better."""
    return gain.before < NO_ERROR


def _gain_clause(gain: Gain) -> str:
    """Return what a gain is, as a clause without its subject; a gain below zero is a larger error."""
    if gain.is_unchanged:
        return "changes nothing on the held-out rows"
    if gain.value >= 0.0:
        return f"gains {gain_text(gain)}"
    low, high = percent(gain.low), percent(gain.high)
    ends = f"95 % interval of the gain {low} to {high}" if gain.high > gain.low else "too few rows for an interval"
    return f"makes the error on the held-out rows {percent(-gain.value)} larger ({ends})"


def _log_score_clause(change: LogScoreChange) -> str:
    """Return what an effect of the noise does to the likelihood of held-out readings, as a clause."""
    size, direction = abs(change.value), "raises" if change.value >= 0.0 else "lowers"
    ends = "too few rows for an interval"
    if change.high > change.low:
        ends = f"95 % interval of the change {change.low:.2g} to {change.high:.2g}"
    return f"the effect {direction} the log-likelihood of a held-out reading by {size:.2g} on average ({ends})"


def _deviations_text(fit: HypothesisFit, besides: HypothesisFit | None = None) -> str:
    """Return, for example, `track_m by 5 tolerances`, the furthest parameter first; empty if none is that far off.

    Args:
        fit: The fit with these parameters.
        besides: Another fit, whose parameters with such deviations are left out.
    """
    known = {name for name, _ in _large_deviations(besides)} if besides is not None else set()
    further = [(name, deviation) for name, deviation in _large_deviations(fit) if name not in known]
    names = ", ".join(f"{name} by {tolerances:.0f}" for name, tolerances in sorted(further, key=lambda item: -item[1]))
    return f"{names} tolerances" if names else ""


def _large_deviations(fit: HypothesisFit) -> list[tuple[str, float]]:
    """Return the parameters that a fit moves far out of their tolerances, each with its deviation in tolerances."""
    deviations = zip(fit.hypothesis.nuisances, np.abs(fit.hypothesis.prior(fit.x)).tolist(), strict=True)
    return [(nuisance.name, deviation) for nuisance, deviation in deviations if deviation >= MIN_DEVIATION]

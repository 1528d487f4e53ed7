"""What the held-out rows say of a name."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.naming.named_model import NamedModel, _gain, _name_evidence
from diagnosis.inference.naming.verdict import withheld
from diagnosis.inference.selection.refusal import CLEAR
from diagnosis.inference.selection.rivals import RivalComparison

X = np.linspace(-1.0, 1.0, 120)


@pytest.mark.parametrize(("heldout_gain", "is_confirmed"), [(1.3, True), (0.8, False)])
def test_an_effect_that_held_out_rows_contradict_gains_less_than_nothing(
    evidence_of, hypothesis, effect, heldout_gain, is_confirmed
):
    """The fitted rows have a gain of 1.3."""
    gains = np.where(np.arange(120) < 90, 1.3, heldout_gain)
    evidence = evidence_of(X, gains * X + 0.01 * np.random.default_rng(6).standard_normal(120), heldout=30)
    gain = effect("current_sensor_gain")
    extended = hypothesis.with_effect(gain)
    base, fit = fits(evidence, [(each, each.null()) for each in (hypothesis, extended)])
    assert (_gain(evidence, base, fit, gain).high > 0.0) is is_confirmed


def test_held_out_rows_cannot_show_what_is_not_held_out_or_predicts_nothing(evidence_of, hypothesis, effect):
    gain = effect("current_sensor_gain")
    extended = hypothesis.with_effect(gain)
    (fit,) = fits(evidence_of(X, X), [(extended, extended.null())])
    assert _gain(fit.evidence, fit, fit, gain) is None
    (fit,) = fits(evidence_of(X, X, heldout=30), [(extended, extended.null())])
    assert _gain(fit.evidence, fit, fit, gain) is not None
    of_noise = replace(fit, slopes=np.zeros_like(fit.slopes))
    assert _gain(fit.evidence, of_noise, of_noise, gain) is None


@pytest.mark.parametrize(("confidence", "stands"), [(0.0, False), (0.5, True)])
def test_a_name_that_nobody_believes_is_withheld_beside_a_structure_too(
    evidence_of, hypothesis, effect, confidence, stands
):
    gain = effect("current_sensor_gain")
    evidence, extended = evidence_of(X, 1.3 * X), hypothesis.with_effect(gain)
    base, fit = fits(evidence, [(each, each.null()) for each in (hypothesis, extended)])
    structure: Any = SimpleNamespace(leaves_only_outliers=False)
    comparison = RivalComparison(gain, confidence, ())
    name = _name_evidence(evidence, base, NamedModel(fit, [comparison], structure), comparison, base)
    assert (not withheld(name)) is stands


def test_outliers_among_the_held_out_rows_say_nothing_against_an_effect_that_leaves_none(
    evidence_of, hypothesis, effect
):
    """The effect changes three rows of the fit. Without it, these are outliers, and others cost less."""
    x = np.where(np.arange(120) % 30 == 5, 1.0, 0.0)
    x[90:] = 0.0
    readings = 1.3 * x + 0.01 * np.random.default_rng(6).standard_normal(120)
    readings[[108, 112, 116]] += 0.5
    gain = effect("current_sensor_gain")
    evidence = evidence_of(x, readings, heldout=15)
    base, fit = fits(evidence, [(each, each.null()) for each in (hypothesis, hypothesis.with_effect(gain))])
    assert float((base.costs - fit.costs)[evidence.heldout].sum()) < -CLEAR
    comparison = RivalComparison(gain, 0.9, ())
    adequate: Any = SimpleNamespace(leaves_only_outliers=True)
    name = _name_evidence(evidence, base, NamedModel(fit, [comparison], adequate), comparison, base)
    assert name.heldout_rise == pytest.approx(0.0, abs=0.5)

"""Sizes of a named effect beside a second one that is too weak for a name: least squares in closed form."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.inference.naming.other_size import OtherSize, other_size
from diagnosis.inference.selection.penalty import PARAMETER_PENALTY
from diagnosis.inference.selection.refusal import THRESHOLD
from diagnosis.inference.selection.rivals import SECOND, RivalComparison

SD_A, ROWS, GAIN = 0.01, 120, 1.3
FITTED = ROWS - 30
X = 0.4 + 0.1 * np.random.default_rng(2).permutation(np.linspace(-1.0, 1.0, ROWS))
BOTH = np.stack([X, np.ones(ROWS)], axis=1)
NOISE = np.random.default_rng(6).standard_normal(ROWS)
EVEN_NOISE = NOISE - BOTH @ np.linalg.lstsq(BOTH, NOISE, rcond=None)[0]
"""Noise that no gain and no offset explains."""


@pytest.fixture
def fitted(evidence_of, hypothesis, effect):
    """The fit of a gain to readings with an offset of some sigmas as well, the evidence, and both effects."""

    def make(sigmas):
        evidence = evidence_of(X, GAIN * X + SD_A * (sigmas + EVEN_NOISE), heldout=30)
        gain, offset = effect("current_sensor_gain"), effect("current_sensor_offset")
        model = replace(hypothesis, nuisances=(), effects=(gain,))
        (fit,) = fits(evidence, [(model, model.null())])
        return evidence, fit, gain, offset

    return make


def test_an_offset_too_weak_for_a_name_widens_the_error_of_the_gain(fitted):
    """Far from zero, a gain takes nearly all of an offset, and is off by 20 standard errors."""
    evidence, fit, gain, offset = fitted(2.4)
    found = other_size(evidence, fit, gain, [gain, offset])
    assert found is not None
    fitted_fall = 2.4**2 * (FITTED - X[:FITTED].sum() ** 2 / (X[:FITTED] @ X[:FITTED]))
    assert fitted_fall < THRESHOLD
    whole_fall = 2.4**2 * (ROWS - X.sum() ** 2 / (X @ X))
    assert found.beside == "current_sensor_offset"
    assert found.rise == pytest.approx(PARAMETER_PENALTY + SECOND - whole_fall, abs=1.5)
    named = NamedEffect.from_comparison(evidence, fit, fit, RivalComparison(gain, 0.97, ()), found)
    error = abs(named.values["gain"] - GAIN)
    assert error > 15.0 * fit.std(gain)["gain"]
    assert error < 3.0 * named.std["gain"]


def test_what_whole_runs_change_is_not_of_the_second_effect(fitted):
    evidence, fit, gain, offset = fitted(2.4)
    found, comparison = other_size(evidence, fit, gain, [gain, offset]), RivalComparison(gain, 0.97, ())
    later = replace(fit, x=fit.x + 0.1, is_of_whole_runs=True)
    before, after = (NamedEffect.from_comparison(evidence, fit, each, comparison, found) for each in (fit, later))
    assert abs(after.values["gain"] - before.values["gain"]) > before.std["gain"]
    assert after.std["gain"] == pytest.approx(before.std["gain"], rel=1e-3)


def test_without_an_offset_there_is_no_other_size(fitted):
    evidence, fit, gain, offset = fitted(0.0)
    assert other_size(evidence, fit, gain, [gain, offset]) is None


def test_a_second_effect_that_leaves_the_number_is_none(evidence_of, hypothesis, effect):
    """About zero, gain and offset are independent."""
    x = np.linspace(-1.0, 1.0, ROWS)
    evidence = evidence_of(x, GAIN * x + 0.35 * SD_A + SD_A * (NOISE - NOISE.mean()))
    gain, offset = effect("current_sensor_gain"), effect("current_sensor_offset")
    model = replace(hypothesis, nuisances=(), effects=(gain,))
    (fit,) = fits(evidence, [(model, model.null())])
    assert other_size(evidence, fit, gain, [gain, offset]) is None


@pytest.mark.parametrize(("rise", "weight"), [(0.0, 0.5), (1e3, 0.0), (-1e3, 1.0)])
def test_the_error_is_the_root_mean_square_deviation_over_both_models(rise, weight):
    """Of a mixture of normal distributions, about the mean of the first one: its second moment."""
    other = OtherSize("other", rise, {"delay_s": 0.013}, {"delay_s": 0.004})
    assert other.weight == pytest.approx(weight, abs=1e-5)
    rng = np.random.default_rng(1)
    deviation = np.where(
        rng.random(400_000) < weight, rng.normal(0.013, 0.004, 400_000), rng.normal(0.0, 0.001, 400_000)
    )
    assert other.wider({"delay_s": 0.001})["delay_s"] == pytest.approx(np.sqrt(np.mean(deviation**2)), rel=0.01)

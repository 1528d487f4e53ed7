"""Intervals from the profile of the cost: of a straight model, of a bent one, and at a bound."""

import numpy as np
import pytest

from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.profile import profiles

SD_A = 0.01
X = np.linspace(0.5, 1.0, 60)


@pytest.fixture
def offset_of(evidence_of, hypothesis, effect):
    """Standard error and intervals of the offset that readings have."""
    model = hypothesis.with_effect(effect("current_sensor_offset"))
    (offset,) = model.effects

    def found(readings):
        evidence = evidence_of(X, readings)
        (fit,) = fits(evidence, [(model, model.null())])
        narrow, wide = profiles(evidence, fit)["current_sensor_offset"]["offset_A"]
        return fit.std(offset)["offset_A"], narrow, wide

    return found


def test_where_the_fit_goes_by_a_logarithm_and_readings_by_the_gain_the_interval_is_as_wide_on_both_sides(
    evidence_of, hypothesis, effect
):
    """Six readings of a hundredth of an ampere determine a gain to a fifth; exp(+-0.39) would lie about 1.08."""
    model = hypothesis.with_effect(effect("current_sensor_gain"))
    x = np.full(6, 0.02)
    evidence = evidence_of(x, x + SD_A * (-1.0) ** np.arange(6))
    (fit,) = fits(evidence, [(model, model.null())])
    _, wide = profiles(evidence, fit)["current_sensor_gain"]["gain"]
    assert wide.low + wide.high == pytest.approx(2.0, abs=0.04)
    # 1.96 standard errors of 0.01 / 0.02 / sqrt(6).
    assert wide.high - 1.0 == pytest.approx(0.40, rel=0.15)


def test_of_a_straight_model_an_interval_is_as_wide_as_its_standard_error_says(offset_of):
    std, narrow, wide = offset_of(X + 0.02 + SD_A * np.random.default_rng(1).standard_normal(len(X)))
    assert wide.high - wide.low == pytest.approx(2 * 1.96 * std, rel=0.1)
    assert narrow.high - narrow.low == pytest.approx(2 * 0.9945 * std, rel=0.1)
    assert not wide.is_open


def test_an_end_at_a_bound_is_open(offset_of, effect):
    highest = effect("current_sensor_offset").kind.parameters()["offset_A"].high
    _, narrow, wide = offset_of(X + highest + SD_A * np.random.default_rng(1).standard_normal(len(X)))
    assert narrow.is_open
    assert wide.is_open
    assert wide.high == pytest.approx(highest)
    assert wide.low < narrow.low < highest

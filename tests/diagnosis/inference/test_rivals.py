"""The confidence in a name among all that would explain the data too."""

from dataclasses import replace
from math import exp

import numpy as np
import pytest

from diagnosis.inference.fit import fits
from diagnosis.inference.likelihood import LEVELS, NoiseFit
from diagnosis.inference.rivals import (
    SECOND,
    SOMETHING_ELSE,
    SOMETHING_ELSE_BESIDE,
    TEMPERATURE,
    compare_rivals,
    confidence,
)
from diagnosis.inference.selection import TOLL

X = np.linspace(-1.0, 1.0, 120)


@pytest.fixture
def bench(evidence_of, hypothesis, effect):
    """A gain of 1.3, with its fit."""
    evidence = evidence_of(X, 1.3 * X + 0.01 * np.random.default_rng(6).standard_normal(120), heldout=30)
    gain = effect("current_sensor_gain")
    model = hypothesis.with_effect(gain)
    (fit,) = fits(evidence, [(model, model.null())])
    return evidence, fit, gain


def test_a_rival_that_is_as_good_halves_the_confidence_and_one_far_away_leaves_it():
    assert confidence([0.0], 1e3, 0.0) == pytest.approx(0.5)
    assert confidence([1e3], 1e3, 0.0) == pytest.approx(1.0)
    assert confidence([], 1e3) == pytest.approx(1.0 / (1.0 + SOMETHING_ELSE))


def test_two_effects_that_explain_as_much_as_one_leave_it_less_sure(bench, effect):
    """The pair has one parameter more, and two effects are rarer than one."""
    evidence, fit, gain = bench
    alone = compare_rivals(evidence, fit, gain, [gain])
    others = fit.hypothesis.without(gain).with_effect(effect("current_sensor_offset"))
    (two,) = fits(evidence, [(others.with_effect(effect("torque_constant_scale")), np.zeros(3))])
    pair = replace(two, cost=fit.cost)
    found = compare_rivals(evidence, fit, gain, [gain], pairs=[pair])
    assert 1.0 / found.confidence - 1.0 / alone.confidence == pytest.approx(exp(-0.5 * (TOLL + SECOND) / TEMPERATURE))
    assert found.others[0] == ("current_sensor_offset and torque_constant_scale together", pytest.approx(TOLL + SECOND))
    with_itself = replace(pair, hypothesis=fit.hypothesis.with_effect(effect("current_sensor_offset")))
    assert compare_rivals(evidence, fit, gain, [gain], pairs=[with_itself]).confidence == alone.confidence


def test_beside_what_stays_unexplained_no_name_is_nearly_certain(bench):
    evidence, fit, gain = bench
    whole = compare_rivals(evidence, fit, gain, [gain])
    noisy = replace(fit, noise=NoiseFit(np.array([LEVELS[1]]), fit.noise.shares))
    for found in (
        compare_rivals(evidence, fit, gain, [gain], is_whole=False),
        compare_rivals(evidence, noisy, gain, [gain]),
    ):
        assert not found.is_whole
        assert found.confidence <= 1.0 / (1.0 + SOMETHING_ELSE_BESIDE) < whole.confidence

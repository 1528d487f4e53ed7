"""The confidence in a name among all that would explain the data too."""

from dataclasses import dataclass, replace
from math import exp

import numpy as np
import pytest
from scipy.stats import norm

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis
from diagnosis.inference.fitting.likelihood import LEVELS, NoiseFit
from diagnosis.inference.selection.rivals import (
    SECOND,
    SOMETHING_ELSE,
    SOMETHING_ELSE_BESIDE,
    TEMPERATURE,
    compare_rivals,
    confidence,
)
from diagnosis.inference.selection.stepwise import TOLL
from diagnosis.predictors.base import Predicted
from sensors.effects.noise_scale import NoiseScale

X = np.linspace(-1.0, 1.0, 120)


@pytest.fixture
def bench(evidence_of, hypothesis, effect):
    """A gain of 1.3, with its fit."""
    evidence = evidence_of(X, 1.3 * X + 0.01 * np.random.default_rng(6).standard_normal(120), heldout=30)
    gain = effect("current_sensor_gain")
    model = hypothesis.with_effect(gain)
    (fit,) = fits(evidence, [(model, model.null())])
    return evidence, fit, gain


@pytest.fixture
def bench_beyond_zero(evidence_of, hypothesis, effect):
    """The same about a current of 2 A, where an offset of 0.6 A would be similar."""
    x = X + 2.0
    evidence = evidence_of(x, 1.3 * x + 0.01 * np.random.default_rng(6).standard_normal(120), heldout=30)
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
    pair = replace(two, cost=two.cost + fit.whole_cost - two.whole_cost)
    found = compare_rivals(evidence, fit, gain, [gain], pairs=[pair])
    assert 1.0 / found.confidence - 1.0 / alone.confidence == pytest.approx(exp(-0.5 * (TOLL + SECOND) / TEMPERATURE))
    assert found.others[0] == ("current_sensor_offset and torque_constant_scale together", pytest.approx(TOLL + SECOND))
    with_itself = replace(pair, hypothesis=fit.hypothesis.with_effect(effect("current_sensor_offset")))
    assert compare_rivals(evidence, fit, gain, [gain], pairs=[with_itself]).confidence == alone.confidence


def test_two_effects_compete_with_two_others_but_not_with_a_pair_that_shares_one(bench, effect):
    """A pair that shares an effect is among the rivals of the other one, and must not count twice."""
    evidence, fit, gain = bench
    names = ("current_sensor_offset", "torque_constant_scale", "friction_warmup")
    offset, scale, warmup = (effect(name) for name in names)
    nominal = fit.hypothesis.without(gain)

    def fitted(*effects):
        model = nominal
        for each in effects:
            model = model.with_effect(each)
        (two,) = fits(evidence, [(model, model.null())])
        return replace(two, cost=two.cost + fit.whole_cost - two.whole_cost)

    both, others, sharing = fitted(gain, offset), fitted(scale, warmup), fitted(gain, scale)
    found = compare_rivals(evidence, both, offset, [], pairs=[sharing, others])
    # The warm-up has two parameters, so that the others have one more than gain and offset.
    assert ("torque_constant_scale and friction_warmup in place of both", pytest.approx(TOLL)) in found.others
    assert "in place of both" not in str(compare_rivals(evidence, both, offset, [], pairs=[sharing]).others)


def test_held_out_rows_count_as_much_as_fitted_ones_against_a_rival(bench_beyond_zero, effect):
    evidence, fit, gain = bench_beyond_zero
    offset = effect("current_sensor_offset")
    (rival,) = compare_rivals(evidence, fit, gain, [gain, offset]).rivals
    worse = rival.fit.cost - fit.cost + float((rival.fit.costs - fit.costs)[evidence.heldout].sum())
    assert rival.worse == pytest.approx(worse)


@dataclass
class Reader:
    """Readings of 0, with the noise of a range sensor."""

    observed: tuple
    name: str = "range"
    at_once: int = 48

    def predict(self, robots):
        sd = self.observed[0].sd
        rows = [self._scale(robot) * sd for robot in robots]
        return (Predicted(np.zeros((len(robots), len(sd))), np.array(rows)),)

    @staticmethod
    def _scale(robot):
        effect = robot.effects.get(NoiseScale)
        return 1.0 if effect is None else effect.scale


@pytest.mark.parametrize("scale", [0.35, 0.4, 2.5])
def test_less_or_more_noise_competes_with_a_statement_that_is_wrong_by_a_factor_of_two(evidence_of, robot, scale):
    """For n readings of standard deviation s, the cost with b in its place is higher by n (s^2 / b^2 - 1 - log of it).

    The readings are the quantiles of a normal distribution.
    """
    readings = scale * 0.01 * norm.ppf((np.arange(200) + 0.5) / 200)
    evidence = Evidence((Reader(evidence_of(np.zeros(200), readings).observed),))
    effect = CandidateEffect(NoiseScale)
    model = Hypothesis(robot, (), (effect,))
    (fit,) = fits(evidence, [(model, model.null())])
    found = compare_rivals(evidence, fit, effect, [effect])
    ratio = (scale / (0.5 if scale < 1.0 else 2.0)) ** 2
    rise = dict(found.others)["a stated noise that is wrong by a factor of 2"]
    assert rise == pytest.approx(200.0 * (ratio - 1.0 - np.log(ratio)), rel=0.15)


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

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
from diagnosis.inference.selection.penalty import PARAMETER_PENALTY
from diagnosis.inference.selection.rivals import (
    SECOND,
    SOMETHING_ELSE,
    SOMETHING_ELSE_BESIDE,
    TEMPERATURE,
    compare_rivals,
    confidence,
    with_random_drift,
)
from diagnosis.nuisances import Nuisance
from diagnosis.predictors.base import Predicted
from sensors.effects.range_sensor.noise_scale import NoiseScale

SD_A = 0.01
X = np.linspace(-1.0, 1.0, 120)
NOISE = np.random.default_rng(6).standard_normal(120)


def scaled(robot, value):
    return robot.model_copy(update={"motor": robot.motor.model_copy(update={"torque_constant_N_m_A": value})})


@pytest.fixture
def bench(evidence_of, hypothesis, effect):
    """A gain of 1.3, with its fit; the noise of all rows has a mean of zero, so that an offset explains nothing."""
    evidence = evidence_of(X, 1.3 * X + SD_A * (NOISE - NOISE.mean()), heldout=30)
    gain = effect("current_sensor_gain")
    model = hypothesis.with_effect(gain)
    (fit,) = fits(evidence, [(model, model.null())])
    return evidence, fit, gain


@pytest.fixture
def bench_near_zero(evidence_of, robot, effect):
    """An offset of 0.4 sigma, seen at small readings, with its fit; only held-out rows show that a number is 10 % off.

    That number has a tolerance of 10 %.
    """
    constant = robot.motor.torque_constant_N_m_A
    nuisance = Nuisance("motor.torque_constant_N_m_A", constant, 0.1 * constant, "N m/A", scaled)
    x = np.append(0.02 + 0.001 * X[:90], np.linspace(0.02, 1.0, 30))
    evidence = evidence_of(x, 1.1 * x + 0.4 * SD_A + SD_A * NOISE, heldout=30)
    offset = effect("current_sensor_offset")
    model = Hypothesis(robot, (nuisance,), (offset,))
    (fit,) = fits(evidence, [(model, model.null())])
    return evidence, fit, offset


def test_a_rival_that_is_as_good_halves_the_confidence_and_one_far_away_leaves_it():
    assert confidence([0.0], 1e3, 0.0) == pytest.approx(0.5)
    assert confidence([1e3], 1e3, 0.0) == pytest.approx(1.0)
    assert confidence([], 1e3) == pytest.approx(1.0 / (1.0 + SOMETHING_ELSE))


def test_two_effects_that_explain_as_much_as_one_leave_it_less_sure(bench, effect):
    """The pair has one parameter more, and two effects are rarer than one."""
    evidence, fit, gain = bench
    alone = compare_rivals(evidence, fit, gain, [gain])
    others = fit.hypothesis.without(gain).with_effect(effect("current_sensor_offset"))
    (pair,) = fits(evidence, [(others.with_effect(effect("torque_constant_scale")), np.zeros(3))])
    found = compare_rivals(evidence, fit, gain, [gain], pairs=[pair])
    weight = exp(-0.5 * (PARAMETER_PENALTY + SECOND) / TEMPERATURE)
    assert 1.0 / found.confidence - 1.0 / alone.confidence == pytest.approx(weight, rel=0.03)
    name = "current_sensor_offset and torque_constant_scale together"
    assert found.others[0] == (name, pytest.approx(PARAMETER_PENALTY + SECOND, abs=0.1))
    with_itself = replace(pair, hypothesis=fit.hypothesis.with_effect(effect("current_sensor_offset")))
    assert compare_rivals(evidence, fit, gain, [gain], pairs=[with_itself]).confidence == alone.confidence


@pytest.mark.parametrize(("tolerances", "is_rival"), [(4.0, True), (1.0, False)])
def test_a_number_far_off_beside_a_name_may_be_a_second_effect_beside_a_rival(
    evidence_of, hypothesis, effect, tolerances, is_rival
):
    """Gain and torque constant scale every reading alike. The zero, with a tolerance of 2 mA, is 4 tolerances off."""
    x, tolerance_A = np.linspace(-1.0, 1.0, 2400), 2e-3
    noise = np.random.default_rng(9).standard_normal(2400)
    evidence = evidence_of(x, 1.3 * x + tolerances * tolerance_A + SD_A * (noise - noise.mean()))
    zero = Nuisance("zero", 0.0, tolerance_A, "A", lambda robot, _value: robot, np.full(2400, tolerance_A))
    gain, *others = (effect(name) for name in ("current_sensor_gain", "torque_constant_scale", "current_sensor_offset"))
    model = replace(hypothesis, nuisances=(*hypothesis.nuisances, zero)).with_effect(gain)
    (fit,) = fits(evidence, [(model, model.null())])
    found = dict(compare_rivals(evidence, fit, gain, [gain, *others]).others)
    # Without the prior of the zero, whose share of the information is that of one reading in a hundred.
    rise = PARAMETER_PENALTY + SECOND - tolerances**2 / (1.0 + (SD_A / tolerance_A) ** 2 / 2400)
    expected = {"torque_constant_scale and current_sensor_offset together": pytest.approx(rise, abs=0.1)}
    assert {name: worse for name, worse in found.items() if "together" in name} == (expected if is_rival else {})


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
        return two

    both, others, sharing = fitted(gain, offset), fitted(scale, warmup), fitted(gain, scale)
    found = compare_rivals(evidence, both, offset, [], pairs=[sharing, others])
    # The warm-up has two parameters, so that the others have one more than gain and offset.
    assert (
        "torque_constant_scale and friction_warmup in place of both",
        pytest.approx(PARAMETER_PENALTY, abs=0.1),
    ) in found.others
    assert "in place of both" not in str(compare_rivals(evidence, both, offset, [], pairs=[sharing]).others)


def test_a_noise_that_may_be_stated_wrongly_is_no_part_of_a_rival(bench, effect):
    """Nobody would name it, so that it does not help two effects against one."""
    evidence, fit, gain = bench
    with_noise = fit.hypothesis.without(gain).with_effect(effect("current_sensor_offset"))
    (pair,) = fits(evidence, [(with_noise.with_effect(CandidateEffect(NoiseScale)), np.zeros(3))])
    alone, found = (compare_rivals(evidence, fit, gain, [gain], pairs=pairs) for pairs in ([], [pair]))
    assert found.others == alone.others


def test_a_random_drift_that_explains_as_much_is_named_beside_the_effect(bench):
    evidence, fit, gain = bench
    alone = compare_rivals(evidence, fit, gain, [gain])
    found = with_random_drift(alone, 2.0)
    assert found.ambiguous_with == ("range_wander",)
    assert 1.0 / found.confidence - 1.0 / alone.confidence == pytest.approx(exp(-0.5 * 2.0 / TEMPERATURE))
    assert found.closest == ("range_wander", 2.0)
    assert with_random_drift(alone, 5.0).ambiguous_with == ()
    assert with_random_drift(alone, np.inf) == alone


def test_a_rival_is_compared_by_all_rows_and_not_by_what_some_rows_leave_open(bench_near_zero, effect):
    """Each model, with the prior of the number, is a linear least-squares problem over all rows.

    From the fitted rows alone, the number may be right, so that the named offset predicts the held-out rows badly.
    """
    evidence, fit, offset = bench_near_zero
    (rival,) = compare_rivals(evidence, fit, offset, [offset, effect("current_sensor_gain")]).rivals
    assert float(fit.costs[evidence.heldout].sum()) > 200.0
    x, y = np.append(0.02 + 0.001 * X[:90], np.linspace(0.02, 1.0, 30)), evidence.values
    with_offset = np.append(np.stack([x, np.ones(120)], axis=1) / SD_A, [[10.0, 0.0]], axis=0)
    squares = np.linalg.lstsq(with_offset, np.append(y / SD_A, 10.0), rcond=None)[1][0]
    squares_with_gain = np.linalg.lstsq(x[:, None] / SD_A, y / SD_A, rcond=None)[1][0]
    assert rival.worse == pytest.approx(squares_with_gain - squares, abs=1.5)
    assert rival.worse > 5.0


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

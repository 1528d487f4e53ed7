"""Which effects are chosen on a bench where a gain and an offset can be told apart, and K from the gain cannot."""

from dataclasses import dataclass

import numpy as np
import pytest

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.selection.rivals import compare_rivals
from diagnosis.inference.selection.scan import scan
from diagnosis.inference.selection.stepwise import select
from diagnosis.predictors.base import Predicted
from physics.robot.model import RobotModel
from sensors.wheels.instruments import read_current_A

SD_A = 0.01
TOLERANCE = 0.02
BEND_A = 0.01
X = np.linspace(-1.0, 1.0, 120)


@pytest.fixture
def effects(effect):
    return [effect("current_sensor_offset"), effect("current_sensor_gain")]


def noise(seed):
    return SD_A * np.random.default_rng(seed).standard_normal(len(X))


@pytest.mark.parametrize("seed", range(20))
def test_where_nothing_is_hidden_nothing_is_named(evidence_of, hypothesis, effects, seed):
    within_tolerance = X * (1.0 + 0.02 * np.random.default_rng(seed).standard_normal())
    found = select(evidence_of(X, within_tolerance + noise(seed + 100), heldout=30), hypothesis, effects)
    assert found.fit.hypothesis.effects == ()


def test_the_hidden_effect_is_named_with_its_size(evidence_of, hypothesis, effects):
    found = select(evidence_of(X, X + 0.02 + noise(1), heldout=30), hypothesis, effects)
    (offset,) = found.fit.hypothesis.effects
    assert offset.name == "current_sensor_offset"
    value, std = found.fit.hypothesis.values(offset, found.fit.x)["offset_A"], found.fit.std(offset)["offset_A"]
    assert abs(value - 0.02) < 3.0 * std
    design = np.stack([0.02 * X[:90], np.ones(90)], axis=1) / (SD_A * found.fit.noise.levels[0])
    covariance = np.linalg.inv(design.T @ design + np.diag([1.0, 0.0]))
    assert std == pytest.approx(np.sqrt(covariance[1, 1]), rel=0.1)


def test_both_of_two_are_named(evidence_of, hypothesis, effects):
    found = select(evidence_of(X, 1.4 * X + 0.05 + noise(2), heldout=30), hypothesis, effects)
    assert {e.name for e in found.fit.hypothesis.effects} == {"current_sensor_offset", "current_sensor_gain"}


def test_a_few_wild_rows_are_no_effect(evidence_of, hypothesis, effects):
    readings = X + noise(3)
    readings[[10, 50]] += 5.0
    found = select(evidence_of(X, readings, heldout=30), hypothesis, effects)
    assert found.fit.hypothesis.effects == ()


@pytest.mark.parametrize(("at_heldout", "named"), [((95, 110), {"current_sensor_gain"}), ((), set())])
def test_what_few_rows_show_is_believed_where_held_out_rows_confirm_it(
    evidence_of, hypothesis, effects, at_heldout, named
):
    """A gain of 1.2 in a bench that hardly ever draws current: in two rows of 90."""
    x = np.zeros(120)
    x[[20, 70, *at_heldout]] = 1.0
    found = select(evidence_of(x, 1.2 * x + noise(5), heldout=30), hypothesis, effects)
    assert {effect.name for effect in found.fit.hypothesis.effects} == named


def test_what_held_out_rows_contradict_is_not_believed(evidence_of, hypothesis, effects):
    """An offset in the rows of the fit alone, at places among those of the others."""
    x = np.random.default_rng(8).permutation(X)
    readings = x + np.where(np.arange(120) < 90, 0.03, 0.0) + noise(4)
    found = select(evidence_of(x, readings, heldout=30), hypothesis, effects)
    assert found.fit.hypothesis.effects == ()


def test_the_look_ahead_foresees_the_fall_of_a_linear_effect(evidence_of, hypothesis, effects):
    evidence = evidence_of(X, X + 0.004 + 0.1 * noise(5))
    (base,) = fits(evidence, [(hypothesis, hypothesis.null())])
    prospect = next(p for p in scan(evidence, base, effects) if p.effect.name == "current_sensor_offset")
    model = hypothesis.with_effect(prospect.effect)
    (fit,) = fits(evidence, [(model, prospect.start)])
    assert prospect.drop == pytest.approx(base.cost - fit.cost, rel=0.1)


def test_a_rival_that_does_the_same_is_told(evidence_of, hypothesis, effect):
    """With I proportional to x alone, a gain of the sensor and a constant of the motor are one."""
    gain, other = effect("current_sensor_gain"), effect("torque_constant_scale")
    evidence = evidence_of(X, 1.3 * X + noise(6), heldout=30)
    fit = select(evidence, hypothesis, [gain]).fit
    found = compare_rivals(evidence, fit, gain, [gain, other])
    assert found.ambiguous_with == ("torque_constant_scale",)
    assert found.confidence == pytest.approx(0.5, abs=0.05)


def test_a_nuisance_bent_far_out_of_its_tolerance_is_named(evidence_of, hypothesis, effect):
    """K off by 30 %, 15 of its tolerances: the data fit as well with or without a name, the prior does not."""
    scale = effect("torque_constant_scale")
    found = select(evidence_of(X, 1.3 * X + noise(7), heldout=30), hypothesis, [scale])
    assert found.fit.hypothesis.effects == (scale,)
    assert found.fit.hypothesis.values(scale, found.fit.x)["scale"] == pytest.approx(1.3, abs=0.01)


@dataclass
class BentBench:
    """I = offset + BEND * t^2, with the torque constant t tolerances above its nominal value."""

    observed: tuple
    nominal_constant: float
    name: str = "motor"
    at_once: int = 48

    def predict(self, robots):
        constants = np.array([RobotModel.from_config(robot).motors.right.torque_constant_N_m_A for robot in robots])
        t = np.log(constants / self.nominal_constant) / TOLERANCE
        offsets = [float(read_current_A(robot.effects, np.zeros(1), np.zeros(1))[0]) for robot in robots]
        means = np.array(offsets) + BEND_A * t**2
        return (Predicted(np.repeat(means[:, None], len(X), axis=1), self.observed[0].sd),)


def test_an_effect_is_found_though_a_nuisance_that_imitates_it_is_far_down_a_bent_valley(
    evidence_of, hypothesis, effects, robot
):
    """Without the effect, the torque constant is 8 tolerances off. All along the valley the readings fit equally well,
    and the prior falls by 64 to its end at 0.
    """
    readings = 64.0 * BEND_A + noise(3)
    bench = BentBench(evidence_of(X, readings).observed, robot.motor.torque_constant_N_m_A)
    found = select(Evidence((bench,)), hypothesis, effects[:1])
    assert found.nominal.prior_cost > 30.0
    (offset,) = found.fit.hypothesis.effects
    assert found.fit.hypothesis.values(offset, found.fit.x)["offset_A"] == pytest.approx(64.0 * BEND_A, rel=0.1)
    assert found.fit.prior_cost < 1.0

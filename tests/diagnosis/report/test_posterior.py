"""posterior.yaml: what it says is what was fitted, with the uncertainty of the fit."""

import math
from dataclasses import replace

import numpy as np
import pytest

from configs.draw import draw_run
from configs.effects.registry import EFFECTS
from configs.loader import load_scenario
from configs.posterior.drawing import mean_robot
from configs.posterior.schema import FILE
from diagnosis.inference.fitting.fit import HypothesisFit, at
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis
from diagnosis.inference.fitting.likelihood import stated_noise
from diagnosis.nuisances import Nuisance, section_nuisance
from diagnosis.posterior.posterior import posterior, posterior_text
from diagnosis.posterior.robot_numbers import robot_numbers
from physics.effects.motor_and_gearbox.gear_backlash import GearBacklash

STEP = 0.5
"""Step of a difference in standard deviations."""


@pytest.fixture
def loaded(tmp_path):
    """The posterior of a diagnosis, as a scenario reads it."""

    def load(diagnosis):
        (tmp_path / FILE).write_text(posterior_text(diagnosis))
        return load_scenario("smoke", [f"like={tmp_path}"])

    return load


def test_the_robot_in_the_middle_is_the_fitted_one(diagnosis_of, loaded):
    diagnosis = diagnosis_of("weak")
    scenario = loaded(diagnosis)
    hypothesis = scenario.like.hypotheses[0]
    assert hypothesis.name == "torque_constant_scale"
    middle = mean_robot(hypothesis).on(scenario.root)
    fitted = diagnosis.extended
    for name in ("winding_resistance_ohm", "torque_constant_N_m_A", "coulomb_friction_N_m"):
        assert middle.plain_at(("robot", "motor", name)) == pytest.approx(getattr(fitted.motor, name), rel=1e-8)
    scale = next(effect.scale for effect in fitted.effects if effect.name == "torque_constant_scale")
    assert middle.plain_at(("robot", "effects", "torque_constant_scale", "scale")) == pytest.approx(scale, rel=1e-8)


def test_the_cost_rises_by_one_at_one_standard_deviation_in_every_direction(diagnosis_of):
    """The cost is -2 log posterior, so that in coordinates with a covariance of 1 its second differences are twice the
    unit matrix. They know nothing of the slopes that the fit works with.
    """
    diagnosis = diagnosis_of("weak")
    fit = diagnosis.fit
    numbers = robot_numbers(fit, diagnosis.extended)
    tolerances = [nuisance.tolerance / nuisance.value for nuisance in fit.hypothesis.nuisances]
    root = STEP * numbers.factor / np.array([*tolerances, 1.0])[:, None]
    size = len(fit.x)
    assert root.shape == (size, size)

    def cost(*moves):
        x = fit.x + sum((sign * root[:, k] for k, sign in moves), start=np.zeros(size))
        return at(fit.evidence, fit.hypothesis, x).cost

    curvature = np.zeros((size, size))
    for i in range(size):
        curvature[i, i] = (cost((i, 1)) - 2.0 * cost() + cost((i, -1))) / STEP**2
        for j in range(i):
            corners = sum(a * b * cost((i, a), (j, b)) for a in (1, -1) for b in (1, -1))
            curvature[i, j] = curvature[j, i] = 0.25 * corners / STEP**2
    assert np.linalg.eigvalsh(0.5 * curvature) == pytest.approx(np.ones(size), abs=0.25)


def test_a_run_is_drawn_near_the_fit_and_states_the_ranges_of_the_effect(diagnosis_of, loaded):
    diagnosis = diagnosis_of("weak")
    spec = draw_run(loaded(diagnosis), "CW", 1)
    assert spec.robot.motor != diagnosis.extended.motor
    resistance = spec.robot.motor.winding_resistance_ohm
    assert resistance == pytest.approx(diagnosis.extended.motor.winding_resistance_ohm, rel=0.06)
    assert {each.effect for each in spec.robot.effect_ranges} == {"torque_constant_scale"}


def test_without_effects_there_is_one_hypothesis_and_a_structure_that_it_leaves_refutes_it(diagnosis_of):
    (plain,), (bumped, *_) = (posterior(diagnosis_of(name)).hypotheses for name in ("plain", "bumped"))
    assert plain.name == "no effect"
    assert plain.weight == 1.0
    assert bumped.numbers
    assert posterior(diagnosis_of("bumped")).unexplained
    assert posterior(diagnosis_of("bumped")).something_else == 1.0
    assert posterior(diagnosis_of("plain")).something_else < 0.05


def test_something_else_is_what_the_confidence_in_the_name_leaves_to_no_hypothesis(diagnosis_of):
    """Without a rival among the hypotheses, it is the whole rest."""
    diagnosis = diagnosis_of("weak")
    (named,) = diagnosis.named
    assert not diagnosis.alternatives
    assert posterior(diagnosis).something_else == pytest.approx(1.0 - named.comparison.confidence)


def test_all_measured_quantities_have_their_range_and_all_channels_their_noise(diagnosis_of):
    result = posterior(diagnosis_of("weak"))
    ranges = {each.quantity: (each.low, each.high) for each in result.measured}
    assert ranges["voltage_V"] == (-5.0, 5.0)
    assert {each.channel for each in result.noise} == {"current_A", "omega_rad_s"}


def _fit(diagnosis, nuisances, effects, x, information):
    """A fit of some nuisances and effects, with this information about its coordinates."""
    hypothesis = Hypothesis(diagnosis.base_robot, nuisances, effects)
    nothing = np.zeros((len(x), len(diagnosis.evidence.values)))
    noise = stated_noise(diagnosis.evidence)
    return HypothesisFit(
        diagnosis.evidence, hypothesis, np.array(x), 0.0, nothing[0], nothing[0] > 0.0, nothing[0] + 1.0, noise,
        nothing, nothing, np.array(information),
    )  # fmt: skip


def test_two_coordinates_of_one_number_add_their_variances_and_a_factor_does_not_change_a_logarithm(diagnosis_of):
    effect = CandidateEffect(EFFECTS.by_name()["wheel_radius_asymmetry"])
    (coordinate,) = effect.coordinates

    def changed(robot, value):
        present = robot.effects.get(effect.kind)
        return robot.with_effect(effect.kind.model_construct(asymmetry=(present.asymmetry if present else 0.0) + value))

    nuisances = (
        section_nuisance("drive", "wheel_diameter_m", "wheel_radius_m", 0.03, 0.0003, factor=2.0),
        Nuisance("wheel_radius_asymmetry", 0.0, 0.003, "1", changed),
    )
    x = [0.5, 1.0, 0.02 / coordinate.unit]
    fit = _fit(diagnosis_of("plain"), nuisances, (effect,), x, np.diag([1.0, 1.0, (coordinate.unit / 0.004) ** 2]))
    diameter, asymmetry = robot_numbers(fit, fit.robot).numbers
    sds = robot_numbers(fit, fit.robot).sd
    assert diameter.value == pytest.approx(0.06 * math.exp(0.5 * 0.01))
    assert diameter.is_log
    assert sds == pytest.approx([0.01, math.hypot(0.003, 0.004)], rel=1e-6)
    assert asymmetry.value == pytest.approx(0.023)
    assert not asymmetry.is_log


def test_an_effect_that_no_drive_can_have_is_left_out_with_its_numbers(diagnosis_of):
    effect = CandidateEffect(GearBacklash)
    diagnosis = diagnosis_of("plain")
    x = [coordinate.start for coordinate in effect.coordinates]
    fit = _fit(diagnosis, (), (effect,), x, 1e4 * np.eye(len(x)))
    (hypothesis,) = posterior(replace(diagnosis, fit=fit)).hypotheses
    assert hypothesis.left_out == ("gear_backlash",)
    assert not [each for each in (*hypothesis.numbers, *hypothesis.fixed) if "gear_backlash" in each.field]

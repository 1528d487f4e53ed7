"""Misfits without a shape, jumps in time, and the channel in which a misfit lives."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.selection.refusal import is_of_noise
from diagnosis.inference.selection.scan import scan
from diagnosis.inference.unexplained.adequacy import Adequacy, adequacy
from diagnosis.inference.unexplained.change import change_in_time
from diagnosis.inference.unexplained.locate import located
from diagnosis.inference.unexplained.retained_effects import retained_effects
from diagnosis.inference.unexplained.scatter import with_scatter
from diagnosis.predictors.wheels.count_noise import CountNoise

SD_A = 0.01
X = np.linspace(0.3, 1.0, 16)


def fitted(evidence, hypothesis):
    (fit,) = fits(evidence, [(hypothesis, hypothesis.null())])
    return fit


def left(evidence, hypothesis):
    fit = fitted(evidence, hypothesis)
    return with_scatter(evidence, fit, adequacy(evidence, fit))


def test_a_third_of_few_rows_far_off_is_more_than_outliers(evidence_of, hypothesis):
    readings = X + SD_A * np.random.default_rng(1).standard_normal(16)
    readings[[2, 5, 6, 9, 11, 12]] += [0.2, -0.15, 0.3, -0.2, 0.2, -0.25]
    assert not left(evidence_of(X, readings), hypothesis).is_adequate


def test_an_outlier_or_noise_a_little_wider_than_stated_is_normal(evidence_of, hypothesis):
    alarms = 0
    for seed in range(150):
        generator = np.random.default_rng(seed)
        readings = X + 1.1 * SD_A * generator.standard_normal(16)
        readings[generator.random(16) < 0.05] += 0.3
        alarms += not left(evidence_of(X, readings), hypothesis).is_adequate
    assert alarms <= 2


def test_a_sample_of_several_readings_is_an_outlier_as_soon_as_one_of_them_is(evidence_of, hypothesis):
    """One reading in twenty is wild: of changes between two places, each with x and y, nearly one in five."""
    x = np.linspace(0.3, 1.0, 400)
    alarms = {1: 0, 4: 0}
    for seed in range(10):
        generator = np.random.default_rng(seed)
        wild = (generator.random((400, 4)) < 0.05).any(axis=1)
        evidence = evidence_of(x, x + SD_A * generator.standard_normal(400) + 0.3 * generator.permuted(wild))
        (stage,) = evidence.stages
        for readings in alarms:
            stage.observed = (replace(stage.observed[0], readings=readings),)
            alarms[readings] += not left(Evidence((stage,)), hypothesis).is_adequate
    assert alarms == {1: 10, 4: 0}


def test_noise_that_nobody_stated_cannot_be_too_wide(evidence_of, hypothesis):
    readings = X + 5.0 * SD_A * np.random.default_rng(2).standard_normal(16)
    evidence = evidence_of(X, readings)
    (stage,) = evidence.stages
    stage.observed = (replace(stage.observed[0], noise_is_stated=False),)
    assert left(Evidence((stage,)), hypothesis).is_adequate


@pytest.mark.parametrize("slope", [0.0, 1e-11])
@pytest.mark.parametrize("seed", range(5))
def test_less_noise_is_no_jump(evidence_of, hypothesis, effect, seed, slope):
    """Readings with a third of the stated noise: a jump in time explains none of it.

    An effect of the noise alone moves the mean by nothing, or by what a sum in another order does.
    """
    x = np.tile(X, 10)
    readings = 1.01 * x + 0.3 * SD_A * np.random.default_rng(seed).standard_normal(160)
    evidence = evidence_of(x, readings, t_s=np.arange(160.0))
    nominal = fitted(evidence, hypothesis)
    model = hypothesis.with_effect(effect("current_sensor_gain"))
    named = fitted(evidence, model)
    quieter = replace(named, sd=0.3 * named.sd, z=named.z / 0.3)
    quieter.slopes[model.parameters(model.effects[0])] = slope
    assert is_of_noise(quieter, model.effects[0])
    assert change_in_time(evidence, nominal, quieter) is None


@pytest.mark.parametrize(("mixed", "covariate"), [(False, "x"), (True, "t_s")])
def test_a_jump_is_told_along_what_went_one_way_all_the_time(evidence_of, hypothesis, effect, mixed, covariate):
    """In a single sweep nobody can tell a moment from a place on the sweep."""
    generator = np.random.default_rng(3)
    x = np.linspace(0.3, 1.0, 60)
    when = generator.permutation(60).astype(float) if mixed else np.arange(60.0)
    readings = x + 0.15 * (when >= 26.0) + SD_A * generator.standard_normal(60)
    evidence = evidence_of(x, readings, t_s=when)
    named = fitted(evidence, hypothesis.with_effect(effect("current_sensor_gain")))
    found = change_in_time(evidence, fitted(evidence, hypothesis), named)
    assert found is not None
    assert found.covariate == covariate
    assert float(found.what.removeprefix("jump at ").removesuffix(" s")) == pytest.approx(26.0, abs=1.0)


def test_a_nominal_number_that_jumps_explains_all_quantities_at_once(evidence_of, hypothesis, effect):
    """Offsets for each of six quantities would be eighteen numbers, for which a jump of two percent is too small."""
    generator = np.random.default_rng(5)
    x, when = np.linspace(0.3, 1.0, 60), generator.permutation(60).astype(float)
    stages = []
    for k in range(6):
        readings = x * (1.0 + 0.02 * (when >= 26.0)) + SD_A * generator.standard_normal(60)
        (stage,) = evidence_of(x, readings, t_s=when).stages
        stage.observed = (replace(stage.observed[0], name=f"current_{k}_A"),)
        stages.append(stage)
    evidence = Evidence(tuple(stages))
    named = fitted(evidence, hypothesis.with_effect(effect("current_sensor_offset")))
    found = change_in_time(evidence, fitted(evidence, hypothesis), named)
    assert found is not None
    assert float(found.what.removeprefix("jump at ").removesuffix(" s")) == pytest.approx(26.0, abs=2.0)


@pytest.mark.parametrize("is_counted", [True, False])
def test_a_jump_of_half_a_sigma_may_be_the_drift_of_a_zero_but_counts_have_none(
    evidence_of, hypothesis, effect, is_counted
):
    generator = np.random.default_rng(7)
    x, when = np.linspace(-1.0, 1.0, 1000), generator.permutation(1000).astype(float)
    readings = x + 0.5 * SD_A * (when >= 400.0) + SD_A * generator.standard_normal(1000)
    (stage,) = evidence_of(x, readings, t_s=when).stages
    apart, known = np.zeros(1000, dtype=bool), np.ones(1000, dtype=bool)
    counted = CountNoise(np.full(1000, 0.8 * SD_A), apart, known, 1e-6, SD_A)
    stage.observed = (replace(stage.observed[0], count_noise=counted if is_counted else None),)
    evidence = Evidence((stage,))
    named = fitted(evidence, hypothesis.with_effect(effect("current_sensor_offset")))
    found = change_in_time(evidence, fitted(evidence, hypothesis), named)
    assert found is not None
    assert found.size < 1.0
    assert Adequacy((found,)).has_cause == is_counted


@pytest.mark.parametrize(("what", "is_found"), [("nothing", True), ("another stage", True), ("same stage", False)])
def test_only_structure_in_a_stage_that_a_jump_changes_makes_it_a_substitute(
    evidence_of, hypothesis, effect, what, is_found
):
    """A wave in the readings of a sensor that never sees the motor says nothing about a friction that has jumped."""
    generator = np.random.default_rng(5)
    x, when = np.linspace(0.3, 1.0, 60), generator.permutation(60).astype(float)
    place = generator.permutation(60) / 60.0
    wave = 6.0 * SD_A * np.sin(2.0 * np.pi * place)
    stages = []
    for k in range(7):
        currents = x if k < 6 else np.zeros(60)
        readings = currents * (1.0 + 0.02 * (when >= 26.0)) + SD_A * generator.standard_normal(60)
        readings += wave * ((what, k) in {("another stage", 6), ("same stage", 2)})
        (stage,) = evidence_of(currents, readings, t_s=when, place=place).stages
        stage.observed = (replace(stage.observed[0], name=f"current_{k}_A"),)
        stages.append(stage)
    evidence = Evidence(tuple(stages))
    named = fitted(evidence, hypothesis.with_effect(effect("current_sensor_offset")))
    assert (change_in_time(evidence, fitted(evidence, hypothesis), named) is not None) == is_found


@pytest.mark.parametrize(("jump", "is_possible"), [(3.0, True), (-0.8, True), (-3.0, False)])
def test_no_positive_number_jumps_below_zero(evidence_of, hypothesis, effect, jump, is_possible):
    """The jumps have the same size in sigmas, and no offset imitates them. The torque constant is positive, so that it
    cannot lose three times its value."""
    generator = np.random.default_rng(5)
    changes, when = np.linspace(-0.01, 0.01, 60), generator.permutation(60).astype(float)
    x = changes / abs(jump)
    stages = []
    for k in range(6):
        readings = x * (1.0 + jump * (when >= 26.0)) + SD_A * generator.standard_normal(60)
        (stage,) = evidence_of(x, readings, t_s=when).stages
        stage.observed = (replace(stage.observed[0], name=f"current_{k}_A"),)
        stages.append(stage)
    evidence = Evidence(tuple(stages))
    named = fitted(evidence, hypothesis.with_effect(effect("current_sensor_offset")))
    assert (change_in_time(evidence, fitted(evidence, hypothesis), named) is not None) == is_possible


def test_a_jump_is_one_of_the_quantity_that_it_explains_and_not_of_the_one_with_the_most_noise(
    evidence_of, hypothesis, effect
):
    generator = np.random.default_rng(6)
    x, when = np.linspace(0.3, 1.0, 60), generator.permutation(60).astype(float)
    stages = []
    for name, noise, jump in (("steady", 2.5, 0.0), ("jumping", 1.0, 0.03)):
        readings = x + jump * (when >= 26.0) + noise * SD_A * generator.standard_normal(60)
        (stage,) = evidence_of(x, readings, t_s=when).stages
        stage.observed = (replace(stage.observed[0], name=name),)
        stages.append(stage)
    evidence = Evidence(tuple(stages))
    named = fitted(evidence, hypothesis.with_effect(effect("current_sensor_offset")))
    found = change_in_time(evidence, fitted(evidence, hypothesis), named)
    assert found is not None
    assert found.observed == "jumping"


@pytest.mark.parametrize("seed", [4, 14])
def test_an_effect_that_acts_from_the_start_is_no_jump(step_log, effect, seed):
    """The ripple of a motor has three numbers, which a ripple from one moment on has as well."""
    evidence, nominal = step_log(seed, torque_ripple={"amplitude_N_m": 0.012, "cycles_per_turn": 4.0, "phase_rad": 0.7})
    (ripple,) = scan(evidence, nominal, [effect("torque_ripple")])
    (named,) = fits(evidence, [(nominal.hypothesis.with_effect(ripple.effect), ripple.start)])
    assert nominal.cost - named.cost > 500.0
    assert change_in_time(evidence, nominal, named) is None


def test_a_name_that_a_nominal_number_imitates_stays_beside_outliers_in_a_row(step_log, effect):
    """Without the name, the friction is six tolerances off, whose squares are nearly the whole fall of the cost."""
    evidence, nominal = step_log(1, coulomb_friction_scale={"scale": 1.4})
    friction = effect("coulomb_friction_scale")
    named = fitted(evidence, nominal.hypothesis.with_effect(friction))
    assert 36.0 < nominal.cost - named.cost < 49.0
    rows = np.isin(np.arange(len(named.z)), [500, 501, 502, 503])
    outliers = replace(adequacy(evidence, named).structures[0], p=0.0, basis=rows[:, None] * 1.0, is_of_outliers=True)
    assert retained_effects(evidence, nominal, named, Adequacy((outliers,))) == [friction]


def test_the_channel_without_which_all_the_rest_is_well(evidence_of, hypothesis):
    """Two quantities share a parameter; only the second is bent, and pulls the parameter away."""
    x = np.linspace(0.2, 1.0, 120)
    generator = np.random.default_rng(7)
    straight = x + SD_A * generator.standard_normal(120)
    bent = x + 0.5 * (x > 0.6) * (x - 0.6) + SD_A * generator.standard_normal(120)
    stages = []
    for name, readings in (("straight", straight), ("bent", bent)):
        (stage,) = evidence_of(x, readings).stages
        stage.observed = (replace(stage.observed[0], name=name, channel=name),)
        stages.append(stage)
    evidence = Evidence(stages)
    found = left(evidence, hypothesis)
    assert {structure.channel for structure in found.structures if structure.p < 0.001} == {"straight", "bent"}
    assert located(evidence, hypothesis, found).worst.channel == "bent"

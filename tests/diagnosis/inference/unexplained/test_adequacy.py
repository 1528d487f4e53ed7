from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.unexplained.adequacy import adequacy, may_be_of_logger
from diagnosis.inference.unexplained.retained_effects import retained_effects
from diagnosis.predictors.base import Predicted, SharedReading

SD_A = 0.01
X = np.linspace(-1.0, 1.0, 160)


def noise(seed):
    return SD_A * np.random.default_rng(seed).standard_normal(len(X))


def fitted(evidence, hypothesis):
    (fit,) = fits(evidence, [(hypothesis, hypothesis.null())])
    return fit


@pytest.mark.parametrize(("seeds", "most"), [(40, 1), pytest.param(150, 2, marks=pytest.mark.long)])
def test_an_adequate_model_is_rarely_called_inadequate(evidence_of, hypothesis, seeds, most):
    """At a level of 0.001, more than this happens once in some 1000 times; outliers, one in 50, change nothing."""
    alarms = 0
    for seed in range(seeds):
        readings = X + noise(seed)
        readings[np.random.default_rng(seed + 1000).random(len(X)) < 0.02] += 0.5
        evidence = evidence_of(X, readings, when=np.random.default_rng(seed).permutation(len(X)))
        alarms += not adequacy(evidence, fitted(evidence, hypothesis)).is_adequate
    assert alarms <= most


@pytest.mark.parametrize("level", [0.3, 1.0, 3.0])
def test_the_level_of_the_noise_does_not_matter(evidence_of, hypothesis, level):
    assert all(
        adequacy(evidence, fitted(evidence, hypothesis)).is_adequate
        for evidence in (evidence_of(X, X + level * noise(seed)) for seed in range(20))
    )


@pytest.mark.parametrize(
    ("hidden", "covariate"),
    [
        (lambda x: 0.02 * np.exp(-((x - 0.3) ** 2) / 0.02), "x"),
        (lambda when: 0.02 * (when > 100), "when"),
        (lambda x: 0.015 * np.sin(2 * np.pi * x / 0.11), "x"),
    ],
)
def test_structure_is_found_along_its_covariate(evidence_of, hypothesis, hidden, covariate):
    when = np.random.default_rng(1).permutation(len(X)).astype(float)
    evidence = evidence_of(X, X + hidden(X if covariate == "x" else when) + noise(9), when=when)
    found = adequacy(evidence, fitted(evidence, hypothesis))
    assert not found.is_adequate
    assert found.worst.covariate == covariate


def test_what_a_parameter_could_take_is_no_structure(evidence_of, hypothesis):
    """K off by four tolerances: fitted at a cost of the prior, but no shape remains."""
    evidence = evidence_of(X, 1.08 * X + noise(11))
    assert adequacy(evidence, fitted(evidence, hypothesis)).is_adequate


def test_a_name_that_stood_in_for_the_unknown_is_given_up_and_another_is_kept(evidence_of, hypothesis, effect):
    """An offset lies in the span of any function of x; a gain cannot be what happened to a third of the rows."""
    when = np.random.default_rng(1).permutation(len(X)).astype(float)
    cases = [
        (effect("current_sensor_offset"), X + 0.05 * np.exp(-((X - 0.5) ** 2) / 0.1), False),
        (effect("current_sensor_gain"), 1.8 * X + 0.02 * (when > 100), True),
    ]
    for hidden, readings, is_kept in cases:
        evidence = evidence_of(X, readings + noise(12), when=when)
        fit, base = fitted(evidence, hypothesis.with_effect(hidden)), fitted(evidence, hypothesis)
        left = adequacy(evidence, fit)
        assert not left.is_adequate
        kept = retained_effects(evidence, base, fit, left)
        assert kept == ([hidden] if is_kept else [])


def test_a_curve_far_below_the_noise_is_no_structure_though_nothing_scatters(evidence_of, hypothesis):
    """A twentieth of a sigma of what is stated, as a simulated log leaves: 160 rows hold 0.2 of cost in it."""
    evidence = evidence_of(X, X + 0.05 * SD_A * np.cos(4.0 * X) + 0.005 * noise(1))
    assert adequacy(evidence, fitted(evidence, hypothesis)).is_adequate


@pytest.mark.parametrize(("correlation", "is_structure"), [(0.0, True), (-0.5, False)])
def test_what_a_change_shares_with_a_later_one_adds_up_along_a_wave(evidence_of, hypothesis, correlation, is_structure):
    """Changes over two places with independent noise have 1 - cos(2 pi 2/5) = 1.8 times their noise along a wave of
    five samples, so that 36 of cost there are worth 20, as chance brings them among so many waves.
    """
    when = np.arange(len(X)) * 1.0
    wave = 0.67 * SD_A * np.sin(2.0 * np.pi * when / 5.0)
    (stage,) = evidence_of(np.zeros(len(X)), wave + noise(3), when=when).stages
    shared = SharedReading(2, np.full(len(X), correlation))
    evidence = Evidence((replace(stage, observed=(replace(stage.observed[0], shared=shared),)),))
    assert adequacy(evidence, fitted(evidence, hypothesis)).is_adequate is not is_structure


@dataclass
class StillStage:
    """A reading that is 0 for every robot."""

    observed: tuple
    name: str = "tof"
    at_once: int = 48

    def predict(self, robots):
        return (Predicted(np.zeros((len(robots), len(X))), self.observed[0].sd),)


def test_what_is_unexplained_in_one_stage_withdraws_no_effect_of_another(evidence_of, hypothesis, effect):
    """Each stage starts from what was measured, so that an offset of a current explains nothing of a range."""
    hidden = effect("current_sensor_offset")
    (first,) = evidence_of(X, X + 0.03 + noise(12)).stages
    bump = 0.2 * np.exp(-((X - 0.5) ** 2) / 0.1)
    for shift, is_kept in ((0.0, True), (1.0, False)):
        observed = replace(first.observed[0], values=X + 0.03 + shift * bump + noise(12))
        ranges = replace(first.observed[0], name="tof_front_m", channel="tof_m", values=bump + noise(13))
        evidence = Evidence((replace(first, observed=(observed,)), StillStage((ranges,))))
        fit, base = fitted(evidence, hypothesis.with_effect(hidden)), fitted(evidence, hypothesis)
        left = adequacy(evidence, fit)
        assert left.worst.p < 1e-9
        assert retained_effects(evidence, base, fit, left) == ([hidden] if is_kept else [])


def test_outliers_in_a_row_are_reported_and_withdraw_no_effect_that_acts_in_all_rows(evidence_of, hypothesis, effect):
    """Three runs of five wild readings are 9 % of the rows; a run of forty has a cause that may be all there is."""
    hidden = effect("current_sensor_offset")
    x = np.random.default_rng(3).permutation(X)
    for length, begins, is_kept in ((5, (20, 70, 120), True), (40, (60,), False)):
        readings = x + 0.03 + noise(12)
        for begin in begins:
            readings[begin : begin + length] += 0.15
        evidence = evidence_of(x, readings, t_s=np.arange(len(x)))
        fit, base = fitted(evidence, hypothesis.with_effect(hidden)), fitted(evidence, hypothesis)
        left = adequacy(evidence, fit)
        assert not left.is_adequate
        assert left.leaves_only_outliers == is_kept
        assert retained_effects(evidence, base, fit, left) == ([hidden] if is_kept else [])


def test_among_many_outliers_in_a_row_chance_brings_no_lasting_structure(evidence_of, hypothesis, effect):
    """24 runs of four wild readings are 6 % of the rows. In the noise beside them no run of rows lasts, and no wave."""
    hidden = effect("current_sensor_offset")
    rows = 1600
    for seed in range(8):
        generator = np.random.default_rng(seed)
        x = generator.uniform(-1.0, 1.0, rows)
        readings = x + 1.5 * SD_A + SD_A * generator.standard_normal(rows)
        for begin in 8 * generator.choice(rows // 8, 24, replace=False):
            readings[begin : begin + 4] += generator.choice([-1.0, 1.0]) * generator.uniform(6.0, 40.0) * SD_A
        evidence = evidence_of(x, readings, trials=6, t_s=np.arange(rows))
        fit, base = fitted(evidence, hypothesis.with_effect(hidden)), fitted(evidence, hypothesis)
        left = adequacy(evidence, fit)
        assert not left.is_adequate
        assert left.leaves_only_outliers
        assert retained_effects(evidence, base, fit, left) == [hidden]


def test_a_run_that_lasts_counts_without_the_outliers_beside_it(evidence_of, hypothesis, effect):
    """A run of 24 rows that are two sigmas off explains far less than the gain; wild readings would explain more."""
    hidden = effect("current_sensor_gain")
    rows = 1600
    generator = np.random.default_rng(2)
    x = generator.uniform(-1.0, 1.0, rows)
    readings = 1.8 * x + SD_A * generator.standard_normal(rows)
    readings[700:724] += 2.0 * SD_A
    for begin in 8 * generator.choice(80, 30, replace=False):
        readings[begin : begin + 4] += generator.choice([-1.0, 1.0]) * 20.0 * SD_A
    evidence = evidence_of(x, readings, trials=6, t_s=np.arange(rows))
    fit, base = fitted(evidence, hypothesis.with_effect(hidden)), fitted(evidence, hypothesis)
    left = adequacy(evidence, fit)
    assert left.has_cause
    assert set(np.flatnonzero(left.worst.basis.any(axis=1))) & set(range(700, 724))
    assert not set(np.flatnonzero(left.worst.basis.any(axis=1))) - set(range(690, 734))
    assert retained_effects(evidence, base, fit, left) == [hidden]


@pytest.mark.parametrize(
    ("places", "max_runs", "is_possible"),
    [
        ([10, 11, 12, 17, 18], 2, True),
        ([10, 11, 12, 17, 18], 1, False),
        ([10, 11, 12, 16], 1, True),
        ([10, 20, 30], 2, False),
        ([*range(10, 21), 30], 2, False),
    ],
)
def test_two_runs_of_a_logger_may_lie_near_each_other_in_time(places, max_runs, is_possible):
    """Three runs, a run of more than eight rows, or two runs along another covariate than time, have another cause."""
    rows = np.zeros(60, dtype=bool)
    rows[places] = True
    assert may_be_of_logger(rows, max_runs) == is_possible

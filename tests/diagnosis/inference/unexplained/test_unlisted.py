"""Errors of simple form as rivals of named effects and of outliers, on a bench where a current is known."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.unexplained.adequacy import Adequacy
from diagnosis.inference.unexplained.unlisted import BETTER, advantage, best_form, with_forms

SD_A = 0.01
ROWS = 40
X = np.linspace(0.2, 1.0, ROWS)
MIXED = np.random.default_rng(5).permutation(len(X))
NOTHING_FOUND = Adequacy(())


@pytest.fixture
def bench_of(evidence_of):
    """Evidence of separate rows, as those of a sweep."""

    def make(*args, **options):
        (stage,) = evidence_of(*args, **options).stages
        stage.observed = (replace(stage.observed[0], is_series=False),)
        return Evidence((stage,))

    return make


def noise(seed, rows=ROWS):
    return SD_A * np.random.default_rng(seed).standard_normal(rows)


def fitted(evidence, hypothesis):
    (fit,) = fits(evidence, [(hypothesis, hypothesis.null())])
    return fit


def left(evidence, hypothesis):
    fit = fitted(evidence, hypothesis)
    return with_forms(evidence, fit, fit, NOTHING_FOUND)


def test_few_rows_on_a_smooth_bump_are_structure_and_no_outliers(bench_of, hypothesis):
    """Seven rows of 40 are up to 40 sigma off, which a fit with outliers leaves out."""
    bump = 40.0 * SD_A * np.exp(-(((X - 0.62) / 0.05) ** 2))
    evidence = bench_of(X[MIXED], (X + bump)[MIXED] + noise(1))
    found = left(evidence, hypothesis)
    assert not found.is_adequate
    assert found.has_cause
    assert found.worst.covariate == "x"
    form = best_form(evidence, fitted(evidence, hypothesis)).form
    assert (form.middle, form.width) == pytest.approx((0.62, 0.05), rel=0.1)


def test_neighbouring_outliers_of_random_size_are_no_structure(bench_of, hypothesis):
    """Four outliers in a row, between 8 and 60 sigma to either side."""
    alarms = 0
    for seed in range(12):
        generator = np.random.default_rng(seed)
        readings = X + noise(seed)
        first = int(generator.integers(36))
        readings[first : first + 4] += (
            SD_A * np.exp(generator.uniform(*np.log([8, 60]), 4)) * generator.choice([-1, 1], 4)
        )
        alarms += not left(bench_of(X, readings), hypothesis).is_adequate
    assert alarms == 0


def test_a_bump_in_a_few_successive_rows_may_be_outliers(bench_of, hypothesis):
    """In a single sweep nobody can distinguish a bump along the current from one in time."""
    bump = 40.0 * SD_A * np.exp(-(((X - 0.62) / 0.05) ** 2))
    found = left(bench_of(X, X + bump + noise(1)), hypothesis)
    assert not found.is_adequate
    assert not found.has_cause


def test_two_outliers_are_no_bump(bench_of, hypothesis):
    """A bump has three numbers, and so goes through any two rows."""
    readings = X + noise(4)
    readings[[20, 21]] += [0.3, 0.5]
    assert left(bench_of(X, readings), hypothesis).is_adequate


def test_a_kink_is_no_gain(bench_of, hypothesis, effect):
    """Above 0.5 A a sensor reads 20 % more of the rest; a gain is the best that a list offers."""
    rows = 120
    x = np.random.default_rng(6).permutation(np.linspace(0.2, 1.0, rows))
    evidence = bench_of(x, x + 0.2 * np.maximum(x - 0.5, 0.0) + noise(2, rows), heldout=30)
    nominal = fitted(evidence, hypothesis)
    named = fitted(evidence, hypothesis.with_effect(effect("current_sensor_gain")))
    assert advantage(evidence, nominal, named) > BETTER
    found = with_forms(evidence, nominal, named, NOTHING_FOUND)
    assert found.has_cause
    assert found.worst.what == "kink"


@pytest.mark.parametrize("name", ["current_sensor_gain", "current_sensor_offset"])
def test_a_true_effect_is_no_simple_form_of_something_else(bench_of, hypothesis, effect, name):
    true = {"current_sensor_gain": 1.2 * X, "current_sensor_offset": X + 0.08}[name]
    for seed in range(3):
        evidence = bench_of(X[MIXED], true[MIXED] + noise(seed), heldout=8)
        named = fitted(evidence, hypothesis.with_effect(effect(name)))
        assert advantage(evidence, fitted(evidence, hypothesis), named) < 0.0
        assert with_forms(evidence, fitted(evidence, hypothesis), named, NOTHING_FOUND).is_adequate


def test_a_gain_that_drifts_is_found_along_the_time(bench_of, hypothesis):
    when = np.arange(len(X), dtype=float)
    evidence = bench_of(X[MIXED], X[MIXED] * (1.0 + 0.004 * when) + noise(3), t_s=when)
    found = left(evidence, hypothesis)
    assert (found.worst.covariate, found.worst.what) == ("t_s", "gain that drifts")


def test_friction_that_differs_while_a_voltage_falls_changes_sign_with_the_current(bench_of, hypothesis):
    """The error changes sign with the current, so that it has no mean over the rows in which the voltage fell."""
    generator = np.random.default_rng(8)
    x = generator.permutation(np.concatenate([X, -X]))
    step = np.diff(np.abs(x), prepend=np.nan)
    readings = x + 0.03 * np.sign(x) * (step < 0.0) + noise(9, 80)
    found = left(bench_of(x, readings, voltage_step_V=step), hypothesis)
    assert found.has_cause
    assert found.worst.covariate == "voltage_step_V"
    assert found.worst.what.endswith("changing sign with the reading")


def test_a_time_series_has_no_forms_along_a_covariate(evidence_of, hypothesis):
    """Errors that last for some rows are chance there."""
    bump = 40.0 * SD_A * np.exp(-(((X - 0.62) / 0.05) ** 2))
    evidence = evidence_of(X[MIXED], (X + bump)[MIXED] + noise(1))
    assert best_form(evidence, fitted(evidence, hypothesis)) is None


def test_a_step_of_a_bench_has_two_levels(bench_of, hypothesis):
    """Two steps beside each other are two errors, and no form lies between those of either."""
    evidence = bench_of(X[MIXED], (X + 0.05 * (X > 0.55) + 0.05 * (X > 0.65))[MIXED] + noise(4))
    best = best_form(evidence, fitted(evidence, hypothesis))
    assert best is not None
    assert best.form.what == "step"
    assert len(np.unique(best.column.round(9))) == 2

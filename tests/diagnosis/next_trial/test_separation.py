"""Separation and precision of models whose best trials are known in closed form."""

import numpy as np
import pytest

from diagnosis.next_trial.exchange import best_units
from diagnosis.next_trial.separation import ModelOfUnits, UnitStatistics

GRID = np.linspace(-1.0, 1.0, 9)
SLOTS = 6
UNIT = np.arange(SLOTS * len(GRID))
"""Each slot has units of its own, so that no setting has a share that could be used up."""
X = np.tile(GRID, SLOTS)
CHOICE = [np.arange(k * len(GRID), (k + 1) * len(GRID)) for k in range(SLOTS)]


def line(intercept, slope, free, before=1e-9, weight=0.5, x=X):
    """Return a line whose columns `free` (of 1 and x) are parameters that the old data hardly determine."""
    columns = np.stack([np.ones_like(x), x])[list(free)]
    parameters = len(columns)
    return ModelOfUnits(intercept + slope * x, columns, before * np.eye(parameters), weight, np.ones(parameters, bool))


def test_a_line_is_determined_best_by_rows_at_both_ends():
    """D-optimal rows of a straight line are half at each end (Atkinson, Donev and Tobias 2007, section 11.2)."""
    statistics = UnitStatistics([line(0.3, 2.0, (0, 1), weight=1.0)], UNIT, len(UNIT))
    units = best_units(statistics, CHOICE, UNIT, statistics.precision)
    assert sorted(X[units].tolist()) == [-1.0] * 3 + [1.0] * 3


def test_a_nominal_parameter_is_not_determined_for_its_own_sake():
    """Of y = x b with a nominal offset that is known, only b counts: all rows are at the ends."""
    model = line(0.0, 1.0, (0, 1), weight=1.0)
    known = ModelOfUnits(model.mean, model.slopes, np.diag([1e9, 1e-9]), 1.0, np.array([False, True]))
    statistics = UnitStatistics([known], UNIT, len(UNIT))
    units = best_units(statistics, CHOICE, UNIT, statistics.precision)
    assert np.abs(X[units]).tolist() == [1.0] * SLOTS


def test_lines_of_equal_slope_are_distinguished_at_the_origin():
    """A line through the origin with a free slope b comes nearest to 1 + x where x^2 is large; at x = 0 it cannot."""
    models = [line(1.0, 1.0, ()), line(0.0, 1.0, (1,))]
    statistics = UnitStatistics(models, UNIT, len(UNIT))
    truth = statistics.pairs.index((0, 1))
    units = best_units(statistics, CHOICE, UNIT, lambda sums: statistics.separations(sums)[..., truth])
    separation = statistics.separations(statistics.of_units.for_units(units).total())[truth]
    assert separation == pytest.approx(np.sqrt(SLOTS))
    # 1 + (1 - b) x has the sum n - (sum x)^2 / sum x^2 at the best b, so that the sum of x must be zero.
    assert X[units].sum() == pytest.approx(0.0)


def test_lines_of_equal_slope_with_a_free_slope_and_offset_cannot_be_distinguished():
    models = [line(1.0, 1.0, ()), line(0.0, 1.0, (0, 1))]
    statistics = UnitStatistics(models, UNIT, len(UNIT))
    separations = statistics.separations(statistics.of_units.total())
    assert separations[statistics.pairs.index((0, 1))] == pytest.approx(0.0, abs=1e-3)


def test_a_separation_is_that_of_a_least_squares_fit_to_old_and_new_rows():
    rng = np.random.default_rng(3)
    mean_a, mean_b, slopes = rng.normal(size=7), rng.normal(size=7), rng.normal(size=(2, 7))
    old = rng.normal(size=(5, 2))
    a = ModelOfUnits(mean_a, np.empty((0, 7)), np.empty((0, 0)), 0.5, np.empty(0, bool))
    b = ModelOfUnits(mean_b, slopes, old.T @ old, 0.5, np.ones(2, bool))
    statistics = UnitStatistics([a, b], np.arange(7), 7)
    whole = np.concatenate([slopes.T, old]), np.concatenate([mean_a - mean_b, np.zeros(5)])
    squares = float(np.linalg.lstsq(*whole, rcond=None)[1][0])
    sums = statistics.of_units.total()
    assert statistics.separations(sums)[statistics.pairs.index((0, 1))] == pytest.approx(np.sqrt(squares))
    remainders, of_old = statistics.remainders(0, 1, sums)
    assert float(remainders @ remainders) + of_old == pytest.approx(squares)


def test_no_setting_has_more_than_a_quarter_of_the_slots():
    statistics = UnitStatistics([line(0.3, 2.0, (0, 1), weight=1.0)], UNIT, len(UNIT))
    setting = UNIT % len(GRID)
    units = best_units(statistics, CHOICE, setting, statistics.precision)
    assert np.bincount(setting[units]).max() == 2

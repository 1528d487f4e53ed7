"""Outliers that gather along a covariate, by the formula of Fisher's exact test."""

from math import comb

import numpy as np
import pytest

from diagnosis.inference.unexplained.outlier_clusters import cluster
from diagnosis.predictors.base import Covariate, CovariateShape

ROWS = 60
ALL = np.ones(ROWS, dtype=bool)
X = np.random.default_rng(1).permutation(np.linspace(0.5, 2.0, ROWS))
ORDER = np.argsort(X)


def z_of(places, size=9.0):
    """Residuals of 0 but for outliers at the given places in the order of X."""
    z = np.zeros(ROWS)
    z[ORDER[list(places)]] = size
    return z


def test_outliers_that_are_neighbours_have_the_probability_of_fishers_test():
    """All five are in a range of five rows; there are 56 such ranges, and two sides."""
    found = cluster(z_of(range(20, 25)), Covariate("x", X), ALL)
    assert found.p == pytest.approx(2.0 * 56.0 / comb(60, 5))
    assert sorted(np.flatnonzero(found.rows)) == sorted(ORDER[20:25])


def test_outliers_that_are_anywhere_gather_nowhere():
    found = cluster(z_of([3, 17, 29, 41, 55]), Covariate("x", X), ALL)
    assert found is None or found.p > 0.2


@pytest.mark.parametrize(("places", "sizes"), [(range(20, 22), [9.0, 9.0]), (range(20, 26), [9.0, -9.0] * 3)])
def test_two_are_no_cluster_and_outliers_of_both_sides_are_noise(places, sizes):
    z = z_of(places)
    z[ORDER[list(places)]] = sizes
    assert cluster(z, Covariate("x", X), ALL) is None


def test_rows_outside_the_fit_do_not_count():
    inside = ALL.copy()
    inside[ORDER[20:22]] = False
    found = cluster(z_of(range(20, 25)), Covariate("x", X), inside)
    assert np.count_nonzero(found.rows) == 3


def test_outliers_at_the_ends_of_both_directions_are_one_cluster():
    """A counter that stops counting is too slow forward and too fast in reverse: 3 of 6 rows each, beyond 1.9."""
    speed = np.concatenate([np.linspace(-2.0, -0.5, 30), np.linspace(0.5, 2.0, 30)])
    z = np.where(np.abs(speed) > 1.88, -9.0 * np.sign(speed), 0.0)
    assert np.count_nonzero(z) == 6
    found = cluster(z, Covariate("omega_rad_s", speed), ALL)
    assert np.count_nonzero(found.rows) == 6
    # Two views of the covariate with two sides each, and 55 ranges of six rows.
    assert found.p == pytest.approx(4.0 * 55.0 / comb(60, 6))


def test_one_material_can_have_all_outliers():
    material = np.arange(ROWS) % 4.0
    z = np.where((material == 2.0) & (np.arange(ROWS) < 24), 9.0, 0.0)
    found = cluster(z, Covariate("material", material, CovariateShape.CATEGORY), ALL)
    assert np.count_nonzero(found.rows) == 6
    assert found.p == pytest.approx(2.0 * 4.0 * comb(15, 6) / comb(60, 6))


def test_a_few_wild_rows_of_a_series_in_a_row_are_one_mistake_and_many_are_a_cause():
    """Along a straight way, rows in a row are neighbours along any covariate."""
    ordered = Covariate("x", np.sort(X))
    z = np.zeros(ROWS)
    z[20:28] = 9.0
    assert cluster(z, ordered, ALL, np.zeros(ROWS, dtype=int)) is None
    assert np.count_nonzero(cluster(z, ordered, ALL).rows) == 8
    z[20:30] = 9.0
    assert np.count_nonzero(cluster(z, ordered, ALL, np.zeros(ROWS, dtype=int)).rows) == 10
    # Three trials with a few wild rows at the same place each have more than chance to do with it.
    z = np.zeros(ROWS)
    z[[5, 6, 25, 26, 45, 46]] = 9.0
    found = cluster(z, Covariate("x", np.arange(ROWS) % 20.0), ALL, np.arange(ROWS) // 20)
    assert found.rows.nonzero()[0].tolist() == [5, 25, 45]


def test_outliers_about_the_corner_at_which_an_outline_begins_are_one_cluster():
    """A box in that corner: three of 60 places before it and two behind it, which are the same range cut elsewhere."""
    outline = Covariate("wall_place_m", X - 0.5, CovariateShape.OUTLINE, corners=(0.0, 0.4, 0.8, 1.2, 1.55))
    found = cluster(z_of([0, 1, 57, 58, 59]), outline, ALL)
    assert np.count_nonzero(found.rows) == 5
    # Two views with two sides each, and 56 ranges of five rows.
    assert found.p == pytest.approx(4.0 * 56.0 / comb(60, 5))


def test_of_all_ranges_the_least_likely_is_taken():
    """By Fisher's test of each of the ranges between two outliers, in whole numbers."""
    for seed in range(5):
        generator = np.random.default_rng(seed)
        places = np.unique(np.concatenate([generator.integers(0, ROWS, 8), generator.integers(20, 30, 4)]))
        found = cluster(z_of(places), Covariate("x", X), ALL)
        k = len(places)
        tails = [
            (ROWS - n + 1)
            * sum(comb(n, i) * comb(ROWS - n, k - i) for i in range(j - a + 1, min(n, k) + 1))
            / comb(ROWS, k)
            for a in range(k)
            for j in range(a + 2, k)
            for n in [places[j] - places[a] + 1]
        ]
        assert (1.0 if found is None else found.p) == pytest.approx(min(1.0, 2.0 * min(tails)))

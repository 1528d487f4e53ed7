"""Walls that are not where they should be, and what stands before them."""

import numpy as np
import pytest

from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.unexplained.adequacy import CLUSTER, LEVEL, Adequacy, adequacy
from diagnosis.inference.unexplained.unlisted import best_form, with_forms

pytestmark = pytest.mark.usefixtures("cases_on_the_path")


@pytest.fixture
def with_error(drive):
    """A nominal fit where the ranges have an error [m], a function of their quantity."""
    evidence, hypothesis = drive

    def of(error_m):
        errors_m = np.zeros(len(evidence.values))
        for observed, place in zip(evidence.observed, evidence.places, strict=True):
            if observed.channel == "tof_m":
                errors_m[place] = np.nan_to_num(error_m(observed))
        (fit,) = fits(evidence.without(-errors_m), [(hypothesis, hypothesis.null())])
        return fit

    return of


def places(observed):
    return next(covariate for covariate in observed.covariates if covariate.name == "wall_place_m")


def turned_wall(observed):
    """The wall at x = room_x_m is 1.5 cm further away at its end, and 1.5 cm nearer where it begins."""
    outline = places(observed)
    begin, end = outline.corners[1:3]
    inside = (outline.values >= begin) & (outline.values < end)
    return np.where(inside, 0.015 * (2.0 * (outline.values - begin) / (end - begin) - 1.0) * outline.size, 0.0)


def test_nothing_is_found_in_a_room_as_it_should_be(with_error):
    fit = with_error(lambda _: 0.0)
    assert with_forms(fit.evidence, fit, fit, Adequacy(())).is_adequate
    assert all(s.p >= LEVEL for s in adequacy(fit.evidence, fit).structures if s.covariate == "wall_place_m")


def test_a_turned_wall_is_found_by_each_sensor_and_as_the_error_of_all(with_error):
    fit = with_error(turned_wall)
    assert best_form(fit.evidence, fit).form.what == "turn of the wall x = room_x_m"
    found = [s for s in adequacy(fit.evidence, fit).structures if s.covariate == "wall_place_m" and s.p < LEVEL]
    assert found


def test_a_box_before_a_wall_is_found_by_its_outliers(with_error):
    """It takes 0.2 m of a quarter of a metre of the wall; a fit takes its rows for outliers."""

    def box(observed):
        outline = places(observed)
        return np.where(np.abs(outline.values - 1.2 * outline.corners[1]) < 0.125, -0.2, 0.0)

    fit = with_error(box)
    clusters = [s for s in adequacy(fit.evidence, fit).structures if s.what == CLUSTER and s.p < LEVEL]
    assert clusters
    assert {s.covariate for s in clusters} >= {"wall_place_m"}

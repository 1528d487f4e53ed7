"""Variances that are probably standard deviations, or in another unit, of estimates whose errors have a known size."""

import numpy as np
import pytest

from symolo.evaluation.estimate import EstimatedTrajectory
from symolo.evaluation.evaluate import evaluate_against

T_S = 0.05 * np.arange(400)
TRUTH = np.column_stack((0.6 * np.cos(0.3 * T_S), 0.6 * np.sin(0.3 * T_S), 0.3 * T_S + 0.5 * np.pi))
SD = np.array([0.004, 0.006, 0.02])
"""Standard deviations of the errors: m, m, rad."""
ERROR = np.random.default_rng(8).normal(0.0, SD, TRUTH.shape)
DEG = 180 / np.pi


def warnings_of(variances):
    covariance = np.tile(np.diag(variances), (len(T_S), 1, 1))
    return evaluate_against(T_S, TRUTH, EstimatedTrajectory(T_S, TRUTH + ERROR, covariance)).warnings


@pytest.mark.parametrize("factor", [0.05, 0.3, 1.0, 3.0, 20.0])
def test_variances_of_a_filter_that_is_too_sure_or_too_careful_are_no_other_unit(factor):
    assert warnings_of(factor * SD**2) == ()


@pytest.mark.parametrize(
    ("variances", "what", "cure"),
    [
        ([*SD[:2], SD[2] ** 2], "places", "standard deviations: give their squares"),
        ([*(1e6 * SD[:2] ** 2), SD[2] ** 2], "places", "in mm2: divide them by 1e6"),
        ([*(1e4 * SD[:2] ** 2), SD[2] ** 2], "places", "in cm2: divide them by 1e4"),
        ([*SD[:2] ** 2, SD[2]], "headings", "standard deviations: give their squares"),
        ([*SD[:2] ** 2, SD[2] * DEG / DEG**2], "", ""),  # 1.1 deg is nearly its own square
        ([*SD[:2] ** 2, (DEG * SD[2]) ** 2], "headings", "in deg2, and were taken for rad2: correct the unit"),
        ([*SD[:2] ** 2, (SD[2] / DEG) ** 2], "headings", "in rad2, and were taken for deg2: correct the unit"),
    ],
)
def test_another_meaning_of_variances_is_named_if_it_makes_them_consistent(variances, what, cure):
    warnings = warnings_of(variances)
    assert len(warnings) == bool(what)
    assert all(f"squared errors of the {what} are" in text and cure in text for text in warnings)


def test_standard_deviations_in_degrees_are_named():
    """0.1 deg: 10 times its square."""
    factor = 0.1 / DEG / SD[2]
    covariance = np.tile(np.diag([*SD[:2] ** 2, 0.1 / DEG**2]), (len(T_S), 1, 1))
    pose = TRUTH + ERROR * [1.0, 1.0, factor]
    assert evaluate_against(T_S, TRUTH, EstimatedTrajectory(T_S, pose, covariance)).warnings == ()
    covariance = np.tile(np.diag([*SD[:2] ** 2, 0.02 / DEG**2]), (len(T_S), 1, 1))
    pose = TRUTH + ERROR * [1.0, 1.0, 0.2 * factor]
    (text,) = evaluate_against(T_S, TRUTH, EstimatedTrajectory(T_S, pose, covariance)).warnings
    assert "headings" in text
    assert "standard deviations" in text


def test_estimates_without_an_error_have_no_wrong_variances():
    covariance = np.tile(np.diag(SD**2), (len(T_S), 1, 1))
    assert evaluate_against(T_S, TRUTH, EstimatedTrajectory(T_S, TRUTH.copy(), covariance)).warnings == ()

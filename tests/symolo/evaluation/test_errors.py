"""ATE and RPE against evo, and NEES against the chi-square distribution."""

import numpy as np
import pytest
from scipy.stats import chi2

from symolo.evaluation.errors import errors_of, nees, pairs_by_distance, pairs_by_time, pose_errors
from symolo.evaluation.estimate import Estimate

T_S = np.arange(101) / 10


def paths():
    yaw = 0.8 * np.sin(0.5 * T_S)
    true = np.column_stack([0.2 * T_S + 0.03 * np.sin(2 * T_S), 0.5 * np.sin(0.4 * T_S), yaw])
    x, y = true[:, 0] * 1.02 + 0.004 * np.sin(7 * T_S), true[:, 1] + 0.001 * T_S
    return true, np.column_stack([x, y, yaw + 0.002 * T_S + 0.01 * np.cos(5 * T_S)])


def estimate_of(pose, sd=1.0):
    return Estimate(np.arange(len(pose)), pose, np.tile(sd**2 * np.eye(3), (len(pose), 1, 1)))


# evo 1.38.1 on these paths as TUM files of twelve digits, `true.txt` and `estimate.txt`, each with `-r trans_part` and
# with `-r angle_rad`; the column rmse (and median, max) of
#     evo_ape tum true.txt estimate.txt
#     evo_rpe tum true.txt estimate.txt --delta 10 --delta_unit f --all_pairs
#     evo_rpe tum true.txt estimate.txt --delta 1 --delta_unit m --all_pairs --pairs_from_reference
BY_EVO = {
    "ate_m": 0.023989,
    "ate_rad": 0.013568,
    "median_m": 0.020892,
    "worst_m": 0.044774,
    "rpe_per_s_m": 0.004501,
    "rpe_per_s_rad": 0.008594,
    "rpe_per_m_m": 0.016034,
    "rpe_per_m_rad": 0.013797,
}


@pytest.mark.parametrize("name", BY_EVO)
def test_errors_are_those_of_evo(name):
    true, estimate = paths()
    assert getattr(errors_of(estimate_of(estimate), T_S, true), name) == pytest.approx(BY_EVO[name], abs=6e-7)


def test_pairs_over_a_metre_are_those_of_evo():
    assert len(pairs_by_distance(paths()[0], 1.0)) == 68


def test_an_error_of_the_start_is_no_error_of_a_movement():
    true, _ = paths()
    c, s = np.cos(0.3), np.sin(0.3)
    turned = np.column_stack(
        [c * true[:, 0] - s * true[:, 1] + 5, s * true[:, 0] + c * true[:, 1] - 2, true[:, 2] + 0.3]
    )
    errors = errors_of(estimate_of(turned), T_S, true)
    assert errors.ate_rad == pytest.approx(0.3)
    assert errors.ate_m > 4.0
    assert [errors.rpe_per_s_m, errors.rpe_per_m_m, errors.rpe_per_m_rad] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)


def test_a_heading_is_compared_around_the_half_turn():
    true = np.array([[0.0, 0.0, np.pi - 0.01]])
    _, off_rad = pose_errors(estimate_of(np.array([[0.0, 0.0, -np.pi + 0.01]])), true)
    assert off_rad[0] == pytest.approx(0.02)


def test_pairs_of_times_that_are_not_there_are_none():
    assert len(pairs_by_time(np.array([0.0, 0.4, 0.9, 1.3]), 1.0)) == 0
    assert pairs_by_time(np.array([0.0, 0.2, 1.0, 1.2]), 1.0).tolist() == [[0, 2], [1, 3]]
    errors = errors_of(estimate_of(np.zeros((2, 3))), np.array([0.0, 0.4]), np.zeros((2, 3)))
    assert errors.rpe_per_s_m is None
    assert errors.rpe_per_m_rad is None


def test_errors_drawn_from_the_stated_covariance_have_the_nees_of_chi_square():
    rng = np.random.Generator(np.random.PCG64(3))
    root = np.tril(rng.normal(size=(3, 3)))
    count = 4000
    truth = rng.uniform(-3, 3, (count, 3))
    estimate = Estimate(
        np.arange(count), truth + rng.normal(size=(count, 3)) @ root.T, np.tile(root @ root.T, (count, 1, 1))
    )
    # Headings are given up to a turn, which a normal deviate of a radian may exceed.
    small = Estimate(estimate.rows, truth + 1e-2 * (estimate.pose - truth), 1e-4 * estimate.covariance)
    low, high = chi2.ppf([0.0005, 0.9995], 3 * count)
    assert low < nees(small, truth).sum() < high
    errors = errors_of(small, np.arange(count) / 20, truth)
    assert errors.within == pytest.approx(0.95, abs=0.012)
    assert errors.nees == pytest.approx(1.0, abs=0.06)

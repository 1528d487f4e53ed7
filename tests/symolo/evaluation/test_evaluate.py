"""Errors of a known estimate by closed forms, alignments, and what is suspicious about an estimate."""

import numpy as np
import pytest

import symolo
from symolo import EstimatedTrajectory, InputError, evaluate
from symolo.evaluation.evaluate import evaluate_against


def test_a_shift_is_the_whole_error_and_no_error_of_a_movement(t_s, truth, at_rows):
    judged = evaluate_against(t_s, truth, at_rows(truth + np.array([0.03, -0.04, 0.02])))
    errors = judged.errors
    assert errors.ate_m == pytest.approx(0.05)
    assert [errors.median_m, errors.worst_m, errors.end_m] == pytest.approx([0.05] * 3)
    assert errors.ate_rad == pytest.approx(0.02)
    # In the frame of a pose whose heading is wrong by 0.02 rad, a movement of d is wrong by 2 d sin(0.01).
    steps = np.hypot(*(truth[20:, :2] - truth[:-20, :2]).T)
    assert errors.rpe_per_s_m == pytest.approx(2 * np.sin(0.01) * np.sqrt(np.mean(steps**2)))
    assert errors.rpe_per_s_rad == pytest.approx(0.0, abs=1e-12)
    assert (errors.nees, errors.within, errors.poses, errors.coverage) == (None, None, 401, 1.0)


def test_nees_is_the_mean_square_of_the_error_in_standard_deviations(t_s, truth, at_rows):
    covariance = np.tile(np.diag([0.01, 0.02, 0.1]) ** 2, (len(t_s), 1, 1))
    judged = evaluate_against(t_s, truth, at_rows(truth + np.array([0.03, -0.04, 0.1]), covariance))
    assert judged.errors.nees == pytest.approx((3**2 + 2**2 + 1**2) / 3)
    assert judged.errors.within == 0.0  # 14 is above 7.81, the 95 % quantile of chi-square with 3 degrees of freedom
    near = evaluate_against(t_s, truth, at_rows(truth + np.array([0.02, 0.02, 0.1]), covariance))
    assert near.errors.within == 1.0  # 4 + 1 + 1


def test_numbers_that_no_map_and_no_method_has_are_refused(t_s, truth, moved, at_rows):
    with pytest.raises(InputError, match=r"pose 0: x \[m\]: got 1e\+160, allowed: up to 1e\+08"):
        at_rows(truth + np.array([1e160, 0.0, 0.0]))
    # The northing of UTM is up to 1e7 m, and can be aligned.
    judged = evaluate_against(t_s, truth, at_rows(moved(truth, 0.3, 5e5, 1e7)), align="se2")
    assert judged.errors.ate_m == pytest.approx(0.0, abs=1e-6)
    nearly_one = np.array([[1.0, 1.0, 0.0], [1.0, 1.0 + 1e-15, 0.0], [0.0, 0.0, 1.0]])
    for matrix in (np.diag([1e-320, 1.0, 1.0]), np.diag([1.0, 1.0, 1e300]), nearly_one):
        with pytest.raises(InputError, match="covariance 0"):
            at_rows(truth, np.tile(matrix, (len(truth), 1, 1)))


def test_the_smallest_and_largest_covariances_have_a_nees(t_s, truth, at_rows):
    variances = np.array([1e-18, 1e18, 1e-6])
    covariance = np.tile(np.diag(variances), (len(truth), 1, 1))
    judged = evaluate_against(t_s, truth, at_rows(truth + 2 * np.sqrt([0.0, 0.0, 1e-6]), covariance))
    assert judged.errors.nees == pytest.approx(4 / 3)


def test_an_se2_alignment_takes_a_turn_and_a_shift_away(t_s, truth, moved, at_rows):
    estimates = at_rows(moved(truth, -0.7, 3.0, -1.0))
    judged = evaluate_against(t_s, truth, estimates, align="se2")
    assert judged.errors.ate_m == pytest.approx(0.0, abs=1e-12)
    assert judged.errors.ate_rad == pytest.approx(0.0, abs=1e-12)
    # p = R(-0.7) q + (3, -1), so q = R(0.7) p - R(0.7) (3, -1).
    c, s = np.cos(0.7), np.sin(0.7)
    movement = judged.movement
    assert [movement.yaw_rad, movement.x_m, movement.y_m] == pytest.approx([0.7, -3 * c - s, -3 * s + c])
    assert judged.warnings == ()


def test_an_alignment_has_the_least_squares(t_s, truth, at_rows):
    rng = np.random.Generator(np.random.PCG64(4))
    estimates = at_rows(truth + 0.02 * rng.standard_normal(truth.shape))
    best = evaluate_against(t_s, truth, estimates, align="se2")
    for turn, x_m, y_m in [(1e-3, 0, 0), (-1e-3, 0, 0), (0, 1e-3, 0), (0, -1e-3, 0), (0, 0, 1e-3), (0, 0, -1e-3)]:
        pose = best.estimate.pose
        middle = pose[:, :2].mean(axis=0)
        c, s = np.cos(turn), np.sin(turn)
        other = (pose[:, :2] - middle) @ np.array([[c, s], [-s, c]]) + middle + [x_m, y_m]
        rms = np.sqrt(np.mean(np.sum((other - truth[:, :2]) ** 2, axis=1)))
        assert rms > best.errors.ate_m


def test_a_start_alignment_moves_the_first_pose_to_the_true_one(t_s, truth, moved, at_rows):
    odometry = moved(truth, -truth[0, 2], 0, 0)
    odometry[:, :2] -= odometry[0, :2]
    judged = evaluate_against(t_s, truth, at_rows(odometry), align="start")
    assert judged.errors.ate_m == pytest.approx(0.0, abs=1e-12)
    drifted = odometry + np.linspace(0, 1, len(t_s))[:, None] * [0.3, 0.4, 0.0]
    assert evaluate_against(t_s, truth, at_rows(drifted), align="start").errors.end_m == pytest.approx(0.5)


def test_the_covariance_turns_with_an_alignment(t_s, truth, moved, at_rows):
    covariance = np.tile(np.diag([0.01, 0.05, 0.02]) ** 2, (len(t_s), 1, 1))
    judged = evaluate_against(t_s, truth, at_rows(moved(truth, -np.pi / 2, 0, 0), covariance), align="se2")
    assert judged.estimate.covariance[7] == pytest.approx(np.diag([0.05, 0.01, 0.02]) ** 2, abs=1e-15)


def test_estimates_at_one_place_cannot_be_aligned(t_s, truth, at_rows):
    """The mean of 0.1 or 0.3 is not exactly that, so the places seem to have a tiny path."""
    for place in ([0.0, 0.0, 0.0], [0.1, 0.3, 0.0]):
        pose = np.zeros_like(truth) + place
        with pytest.raises(InputError, match="cannot be aligned"):
            evaluate_against(t_s, truth, at_rows(pose), align="se2")
        assert evaluate_against(t_s, truth, at_rows(pose)).errors.ate_m > 1.0


def test_a_mirrored_circle_draws_the_warning_of_its_axis(t_s, at_rows):
    """All turns of a mirrored circle are as far from the circle."""
    phase = 2 * np.pi * t_s / (t_s[-1] + 0.05)
    circle = np.column_stack([np.cos(phase), np.sin(phase), phase + np.pi / 2])
    (warning,) = evaluate_against(t_s, circle, at_rows(circle * [1.0, -1.0, -1.0])).warnings
    assert "the y axis may point to the right" in warning


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda pose: pose * [1000, 1000, 1], "the places are probably millimetres; divide them by 1000"),
        (lambda pose: pose * [100, 100, 1] + [40, 0, 0], "the places are probably centimetres"),
        (lambda pose: pose * [1, 1, 180 / np.pi], "the headings are probably degrees, and were taken for radians"),
        (lambda pose: pose * [1, 1, np.pi / 180], "the headings are probably radians, and were taken for degrees"),
    ],
)
def test_other_units_are_refused(t_s, truth, at_rows, change, message):
    with pytest.raises(InputError) as refused:
        evaluate_against(t_s, truth, at_rows(change(truth)))
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda pose, moved: moved(pose, np.pi / 2, 0, 0), "after a turn of -90.0 deg and a shift of (0.000, 0.000)"),
        (lambda pose, _: pose + np.array([1.0, -2.0, 0]), "a turn of 0.0 deg and a shift of (-1.000, 2.000) m"),
        (lambda pose, _: pose * [1, -1, -1] + [0, 0.3, 0], "with the other sign of y: the y axis may point"),
        (
            lambda pose, _: pose + np.array([0, 0, np.pi / 2]),
            "differ from the true ones by a constant 90 deg",
        ),
        (lambda pose, _: pose + np.array([0, 0, np.pi]), "differ from the true ones by a constant 180 deg"),
        (lambda pose, _: pose - np.array([0, 0, np.pi / 2]), "differ from the true ones by a constant -90 deg"),
        (lambda pose, _: pose * [1, 1, -1], "with the other sign: they may be counted clockwise"),
        (lambda pose, _: pose * [1, 1, -1] + [0, 0, np.pi / 2], "as 90 deg less the heading: they may be counted"),
        (
            lambda pose, _: pose + 0.05 * np.column_stack([np.cos(pose[:, 2]), np.sin(pose[:, 2]), 0 * pose[:, 2]]),
            "ATE would be 0.000 m in place of 0.050 m for a point of the robot 0.050 m ahead of the middle of its axle",
        ),
        (
            lambda pose, _: pose + 0.2 * np.column_stack([np.sin(pose[:, 2]), -np.cos(pose[:, 2]), 0 * pose[:, 2]]),
            "for a point of the robot 0.200 m to the right of the middle of its axle",
        ),
    ],
)
def test_another_frame_axis_or_point_is_a_warning(t_s, truth, at_rows, moved, change, message):
    (warning,) = evaluate_against(t_s, truth, at_rows(change(truth, moved))).warnings
    assert message in warning


@pytest.mark.parametrize("late_s", [-1.0, -0.25, 0.5, 2.0, 5.0])
def test_times_that_are_late_or_early_are_a_warning_with_the_shift(t_s, truth, late_s):
    rng = np.random.Generator(np.random.PCG64(6))
    late = EstimatedTrajectory(t_s + late_s, truth + [0.002, 0.002, 0.01] * rng.standard_normal(truth.shape))
    (warning,) = evaluate_against(t_s, truth, late).warnings
    change = f"subtracting {late_s:.2f} s from" if late_s > 0 else f"adding {-late_s:.2f} s to"
    assert f"after {change} the times: they may count from another moment" in warning


def test_a_shift_of_a_straight_drive_is_explained_by_the_frame_alone(t_s, at_rows):
    """Along a straight line at constant speed, a shift, a point ahead and late times are the same."""
    straight = np.column_stack([0.1 * t_s, 0 * t_s, 0 * t_s])
    (warning,) = evaluate_against(t_s, straight, at_rows(straight + np.array([0.3, 0.0, 0.0]))).warnings
    assert "the estimates may be in another frame" in warning
    assert evaluate_against(t_s, straight, at_rows(straight + np.array([0.03, 0.03, 0.0]))).warnings == ()


def test_noise_and_drift_are_no_suspicion(t_s, truth, at_rows):
    rng = np.random.Generator(np.random.PCG64(5))
    noisy = truth + [0.3, 0.3, 0.3] * rng.standard_normal(truth.shape)
    drifting = truth + (t_s / 20)[:, None] ** 2 * [0.8, -0.5, 0.6]
    for pose in (truth, noisy, drifting, truth + np.array([0.02, 0.0, 0.01])):
        assert evaluate_against(t_s, truth, at_rows(pose)).warnings == ()


def test_a_run_of_a_dataset_is_judged_by_its_data_csv(painted):
    run = symolo.load(painted()).runs[0]
    pose = run.table.pose + np.array([0.0, 0.02, 0.0])
    assert evaluate(run, EstimatedTrajectory(run.t_s, pose)).errors.ate_m == pytest.approx(0.02)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"t_s": [0.0, 0.2, 0.1]}, "t_s: time 2, 0.1 s, is not after 0.2 s; sort the poses by time"),
        ({"pose": np.zeros((2, 3))}, "pose: the shape (2, 3); allowed: (3, 3), as there are 3 times"),
        ({"pose": [[0, 0, 0], [0, np.nan, 0], [0, 0, 0]]}, "pose: pose 1 has a number that is not finite"),
        ({"covariance": np.zeros((3, 3, 3))}, "covariance 0 is not a covariance matrix"),
        (
            {"covariance": np.tile([[1, 2, 0], [0, 1, 0], [0, 0, 1.0]], (3, 1, 1))},
            "covariance 0 is not a covariance matrix",
        ),
        ({"t_s": [], "pose": np.zeros((0, 3))}, "an estimate without poses"),
        ({"pose": "abc"}, "pose: got 'abc'"),
    ],
)
def test_impossible_estimates_are_refused(change, message):
    with pytest.raises(InputError) as refused:
        EstimatedTrajectory(**{"t_s": [0.0, 0.1, 0.2], "pose": np.zeros((3, 3))} | change)
    assert message in str(refused.value)


def test_unknown_alignments_and_gaps_are_refused(t_s, truth, at_rows):
    with pytest.raises(InputError, match="did you mean se2"):
        evaluate_against(t_s, truth, at_rows(truth), align="se3")
    with pytest.raises(InputError, match="a time in s, 0 or more"):
        evaluate_against(t_s, truth, at_rows(truth), max_gap_s=-1)

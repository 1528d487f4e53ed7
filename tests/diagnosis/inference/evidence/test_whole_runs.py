"""Wheels planted by an odometry of the test's own are found from whole runs, with errors that hold."""

import numpy as np
import pytest

from configs.effects.registry import EFFECTS
from diagnosis.inference.evidence.whole_runs import MIN_RUNS, WholeRuns, fitted_to_whole_runs
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis, deviated
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.nominal_robot import nominal_robot
from diagnosis.nuisances import nuisances
from diagnosis.usual_tolerances import usual_wheels
from symolo.core.tables.time_series import TimeSeries

COUNTS = 2000
NOMINAL = usual_wheels(diameter_m=0.08, track_m=0.2, counts_per_turn=COUNTS)
ROWS = 600


def driven(seed, *, left_m=0.0400, right_m=0.0402, track_m=0.2024, start_noise_rad=0.004, slip_rad=1.5e-4):
    """A run on an arc of either sense, then a turn on the spot and a straight, seen by a camera in no special place."""
    noise = np.random.default_rng(seed)
    sense = 1 if seed % 2 else -1
    speed = np.r_[np.full(400, 0.05), np.zeros(80), np.full(ROWS - 480, 0.06)] * 0.05
    turn = np.r_[np.full(400, 0.1), np.full(80, 0.4), np.zeros(ROWS - 480)] * 0.05 * sense
    right, left = (np.cumsum(np.rint((speed + side * turn * 0.1) / (2 * np.pi * 0.04) * COUNTS)) for side in (1, -1))
    steps = np.diff(np.stack([right, left], axis=1), axis=0, prepend=0.0) * 2 * np.pi / COUNTS
    steps[0] = 0.0
    steps += slip_rad * noise.standard_normal(steps.shape)
    ways = steps * [right_m, left_m]
    dtheta = (ways[:, 0] - ways[:, 1]) / track_m
    yaw = np.cumsum(dtheta)
    x, y = (np.cumsum(ways.mean(axis=1) * of(yaw - dtheta / 2)) for of in (np.cos, np.sin))
    seen = np.stack([x, y, yaw], axis=1) - [x[0], y[0], yaw[0]]
    theta = seen[:, 2] + 0.3 + start_noise_rad * noise.standard_normal(ROWS)
    c, s = np.cos(0.3), np.sin(0.3)
    columns = {
        "enc_right_ticks": right,
        "enc_left_ticks": left,
        "x_m": 1.0 + c * seen[:, 0] - s * seen[:, 1] + 2e-4 * noise.standard_normal(ROWS),
        "y_m": 2.0 + s * seen[:, 0] + c * seen[:, 1] + 2e-4 * noise.standard_normal(ROWS),
        "theta_rad": theta,
    }
    t_s = 0.05 * np.arange(ROWS)
    channels = tuple(Channel.logged(TimeSeries(n, "", t_s, v.copy()), Role.READING) for n, v in columns.items())
    return Trial(str(seed), t_s, np.zeros(ROWS, dtype=bool), channels)


def measured(runs=8, **wheels):
    trials = tuple(driven(seed, **wheels) for seed in range(runs))
    return Measurement("made", CaseKind.DRIVE_LOG, MeasurementSource("test", ()), trials, NOMINAL)


@pytest.fixture
def bare(robot):
    return Hypothesis(nominal_robot(NOMINAL, robot), nuisances(NOMINAL))


def of_name(name):
    return CandidateEffect(next(effect for effect in EFFECTS.classes() if effect.name == name))


def test_planted_wheels_are_found_within_three_standard_errors(bare):
    fit = fitted_to_whole_runs(measured(), bare, bare.null(), ())
    errors = np.sqrt(np.diag(fit.covariance))
    truth = {"wheel_radius_m": 0.0401, "wheel_separation_m": 0.2024, "wheel_radius_asymmetry": -0.0002 / 0.0401}
    for nuisance, x, error in zip(bare.nuisances, fit.x, errors, strict=True):
        off = deviated(nuisance, x) - truth[nuisance.name]
        assert abs(off) < 3.0 * error * nuisance.tolerance
        assert error < 0.5
    assert fit.heading_rad < 0.01


def test_a_run_is_predicted_from_its_first_pose_wherever_the_camera_stands(bare):
    """Of the nominal robot, driven without noise, by the nominal robot."""
    made = measured(2, left_m=0.04, right_m=0.04, track_m=0.2, start_noise_rad=0.0, slip_rad=0.0)
    errors = WholeRuns(made, bare.nominal).errors(bare.nominal)
    assert errors.shape == (2, 20, 3)
    assert np.abs(errors).max() < 1.5e-3


def test_wheels_far_out_of_tolerance_are_an_effect_by_name(bare):
    fit = fitted_to_whole_runs(
        measured(left_m=0.0412, right_m=0.0388), bare, bare.null(), (of_name("wheel_radius_asymmetry"),)
    )
    (effect,) = fit.hypothesis.effects
    found = fit.hypothesis.values(effect, fit.x)["asymmetry"] + deviated(bare.nuisances[2], fit.x[2])
    assert found == pytest.approx(0.06, abs=2e-3)


def test_wheels_within_tolerance_are_none(bare):
    fit = fitted_to_whole_runs(measured(), bare, bare.null(), (of_name("wheelbase_scale"), of_name("turn_slip")))
    assert fit.hypothesis.effects == ()


def test_few_runs_tell_nothing_of_their_scatter(bare):
    assert fitted_to_whole_runs(measured(MIN_RUNS - 1), bare, bare.null(), ()) is None


def test_an_angle_of_the_tracked_body_is_left_to_the_windows(bare):
    """Every start is free to turn, so that whole runs do not show the angle."""
    askew = bare.with_effect(of_name("marker_yaw"))
    fit = fitted_to_whole_runs(measured(4), askew, np.append(bare.null(), 1.3), ())
    assert fit.x[-1] == 1.3
    assert fit.covariance[-1].tolist() == [0.0] * len(fit.x)
    assert (np.diag(fit.covariance)[:-1] > 0.0).all()

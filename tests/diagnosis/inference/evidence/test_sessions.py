"""Errors that belong to a session are fitted as such, and never named as effects of the robot."""

import re
from dataclasses import replace

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from diagnosis.diagnose import diagnose
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.sessions import (
    SESSION_ERRORS,
    SessionNuisance,
    fitted_errors,
    session_nuisances,
    within_sessions,
)
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import Hypothesis
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.nominal_robot import nominal_robot
from diagnosis.nuisances import Nuisance
from diagnosis.predictors import STAGES
from diagnosis.report.sentences.data.sessions import session_sentences
from diagnosis.usual_tolerances import usual_wheels
from sensors.effects.pose_log.marker_yaw import MarkerYaw
from symolo.core.tables.time_series import TimeSeries

COUNTS = 20_000
WHEELS = usual_wheels(diameter_m=0.08, track_m=0.2, counts_per_turn=COUNTS)
ROWS, ROW_S = 400, 0.05
XY_M, HEADING_RAD = 2e-4, 1e-3
YAW_TOLERANCE = next(error.tolerance for error in SESSION_ERRORS if error.number == "angle_rad")


def driven(seed, session, yaw_rad, *, held=False):
    """A straight, an arc and a straight of the nominal robot, seen by a body that is turned by `yaw_rad`."""
    noise = np.random.default_rng(seed)
    sense = 1 if seed % 2 else -1
    forward = np.r_[0.0, np.full(ROWS - 1, 0.1 * ROW_S)]
    turn = np.r_[np.zeros(150), np.full(100, 0.5), np.zeros(ROWS - 250)] * ROW_S * sense
    yaw = np.cumsum(turn)
    x, y = (np.cumsum(forward * of(yaw - turn / 2)) for of in (np.cos, np.sin))
    right, left = (np.rint(np.cumsum(forward + side * turn * 0.1) / (2 * np.pi * 0.04) * COUNTS) for side in (1, -1))
    columns = {
        "enc_right_ticks": right,
        "enc_left_ticks": left,
        "x_m": x + XY_M * noise.standard_normal(ROWS),
        "y_m": y + XY_M * noise.standard_normal(ROWS),
        "theta_rad": yaw + yaw_rad + HEADING_RAD * noise.standard_normal(ROWS),
    }
    t_s = ROW_S * np.arange(ROWS)
    channels = tuple(Channel.logged(TimeSeries(n, "", t_s, v), Role.READING) for n, v in columns.items())
    return Trial(f"{session}/{seed}", t_s, np.full(ROWS, held), channels, session=session)


def measured(yaws, *, runs=4):
    """Sessions by name, each with the angle of its tracked body; the last run of each is held out."""
    trials = tuple(
        driven(100 * k + run, session, yaw, held=run == runs - 1)
        for k, (session, yaw) in enumerate(yaws.items())
        for run in range(runs)
    )
    return Measurement("made", CaseKind.DRIVE_LOG, MeasurementSource("test", ()), trials, WHEELS)


def without_sessions(measurement):
    return replace(measurement, trials=tuple(replace(trial, session="") for trial in measurement.trials))


def simulated(measurement):
    robot = nominal_robot(WHEELS, draw_robot(load_section("robot", "nominal"), 1, "test")[0])
    return Evidence(STAGES[CaseKind.DRIVE_LOG](measurement, robot)), robot


def test_a_turned_body_turns_the_increments_of_its_session_alone():
    """Seen from a body that is turned by a, an increment (dx, dy) is (dx cos a + dy sin a, dy cos a - dx sin a).

    Its derivative by a is (dy, -dx).
    """
    measurement = measured({"morning": 0.0, "evening": 0.0}, runs=2)
    evidence, robot = simulated(measurement)
    nuisances = {n.name: n for n in session_nuisances(measurement, evidence, robot)}
    before = evidence.predicted([robot]).mean[0]
    dx, dy, _ = (before[place] for place in evidence.places)
    expected = YAW_TOLERANCE * np.concatenate([dy, -dx, np.zeros_like(dx)])
    expected[evidence.trial >= 2] = 0.0
    change = nuisances["marker_yaw of session morning"].change
    assert change == pytest.approx(np.where(np.isfinite(evidence.values), expected, 0.0), rel=1e-5, abs=1e-12)


def test_no_session_is_no_nuisance():
    measurement = without_sessions(measured({"": 0.0}, runs=2))
    assert session_nuisances(measurement, *simulated(measurement)) == ()


def test_errors_of_two_sessions_are_those_of_a_ridge_regression(evidence_of, robot):
    """Readings r = b_s + noise with b_s ~ N(0, t^2): the posterior mean is sum(r) / (n + sd^2/t^2), its variance
    sd^2 / (n + sd^2/t^2).
    """
    sd, tolerance = 0.01, 0.02
    readings = sd * np.random.default_rng(1).standard_normal(40) + np.repeat([0.03, -0.02], 20)
    evidence = evidence_of(np.zeros(40), readings)
    rows = np.arange(40) < 20
    made = [
        Nuisance(name, 0.0, tolerance, "A", lambda robot, _: robot, np.where(here, tolerance, 0.0))
        for name, here in (("first", rows), ("second", ~rows))
    ]
    (fit,) = fits(evidence, [(Hypothesis(robot, tuple(made)), np.zeros(2))])
    level = fit.noise.levels[0]
    for k, here in enumerate((rows, ~rows)):
        ratio = (level * sd / tolerance) ** 2
        assert tolerance * fit.x[k] == pytest.approx(readings[here].sum() / (20 + ratio), rel=0.02)
        assert tolerance * np.sqrt(fit.covariance[k, k]) == pytest.approx(level * sd / np.sqrt(20 + ratio), rel=0.02)


@pytest.mark.parametrize(
    ("tolerances", "is_shared"),
    [((4.0, 4.0), True), ((-4.0, -4.0), True), ((4.0, -4.0), False), ((4.0, 1.0), False)],
)
def test_only_an_error_that_all_sessions_share_with_its_sign_may_be_an_effect(
    tolerances, is_shared, evidence_of, robot
):
    error = SESSION_ERRORS[0]
    readings = error.tolerance * np.repeat(tolerances, 20) + 1e-3 * np.random.default_rng(2).standard_normal(40)
    rows = np.arange(40) < 20
    made = [
        SessionNuisance(
            name,
            0.0,
            error.tolerance,
            "rad",
            lambda robot, _: robot,
            np.where(here, error.tolerance, 0.0),
            session=name,
            error=error,
        )
        for name, here in (("first", rows), ("second", ~rows))
    ]
    (fit,) = fits(evidence_of(np.zeros(40), readings), [(Hypothesis(robot, tuple(made)), np.zeros(2))])
    assert fit.x == pytest.approx(tolerances, abs=0.5)
    assert (error.effect not in within_sessions(fit)) == is_shared


def test_headings_of_sessions_are_found_and_nothing_is_named(diagnosed_among):
    yaws = {"morning": 0.012, "noon": -0.008, "evening": 0.004}
    measurement = measured(yaws)
    diagnosis = diagnose(measurement)
    assert diagnosis.names == ()
    assert diagnosis.unexplained is None
    headings = {e.session: e for e in fitted_errors(diagnosis.fit) if e.effect == "marker_yaw"}
    for session, yaw in yaws.items():
        assert abs(headings[session].value - yaw) < 3.0 * headings[session].std
        assert headings[session].std < 1e-3
    text = next(text for text in session_sentences(diagnosis.fit) if "heading" in text)
    ahead = r"ahead of that of the robot by 1[12]\.\d+ ± 0\.\d+ \(morning\), .* mrad"
    assert re.search(rf"{ahead}, and behind that of the robot by [78]\.\d+ ± 0\.\d+ \(noon\) mrad", text)
    # Of the same log, without saying which run is of which session, an angle explains only what the sessions share.
    assert diagnosis.fit.cost < diagnosed_among(without_sessions(measurement), "marker_yaw").fit.cost - 50.0


def test_an_angle_far_beyond_a_body_set_by_eye_is_an_effect_by_name(diagnosed_among):
    others = ("wheel_radius_scale", "wheel_radius_asymmetry", "wheelbase_scale", "floor_slope", "marker_offset")
    measurement = measured({"morning": 0.25, "noon": 0.25, "evening": 0.25})
    diagnosis = diagnosed_among(measurement, "marker_yaw", *others)
    (named,) = diagnosis.named
    assert named.name == "marker_yaw"
    assert named.values["angle_rad"] == pytest.approx(0.25, abs=0.05)


def test_beside_a_long_pause_the_heading_before_it_is_an_effect_and_its_change_is_none(effect):
    """Nobody says that the tracked body was set again, but somebody had an hour for it."""
    trials = without_sessions(measured({"1": -0.03, "2": -0.01}, runs=2)).trials
    trials = tuple(
        replace(trial, begins_s=at_s) for trial, at_s in zip(trials, (0.0, 60.0, 3660.0, 3720.0), strict=True)
    )
    measurement = replace(measured({"1": 0.0}), trials=trials)
    evidence, robot = simulated(measurement)
    hypothesis = Hypothesis(robot, session_nuisances(measurement, evidence, robot)).with_effect(effect("marker_yaw"))
    (fit,) = fits(evidence, [(hypothesis, hypothesis.null())])
    assert within_sessions(fit) == set()
    (change,) = fitted_errors(fit)
    assert abs(change.value - 0.02) < 3.0 * change.std < 0.006
    assert abs(fit.robot.effects.get(MarkerYaw).angle_rad + 0.03) < 3.0 * change.std
    (text,) = session_sentences(fit)
    assert re.match(
        r"Since the pause before trial 2/100, the tracked heading is (19|2\d)\.\d+ ± .* mrad ahead of", text
    )


def test_after_a_short_pause_the_heading_is_the_same():
    trials = without_sessions(measured({"1": 0.0}, runs=2)).trials
    trials = tuple(replace(trial, begins_s=at_s) for trial, at_s in zip(trials, (0.0, 90.0), strict=True))
    measurement = replace(measured({"1": 0.0}), trials=trials)
    assert session_nuisances(measurement, *simulated(measurement)) == ()

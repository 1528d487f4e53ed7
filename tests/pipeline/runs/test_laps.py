"""The closed loop in PyBullet: both routes, whole laps, twenty seeds each."""

import io
import itertools
import re

import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from physics.bullet import body
from pipeline.stages.simulate import simulate

STATES = {"CW": [0, 1, 5, 1, 2, 4, 2, 0, 5, 0], "CCW": [0, 5, 0, 1, 3, 1, 2, 6, 2, 0]}
"""State order of SPEC section 4."""


def spec_of(route, *overrides):
    return draw_run(load_scenario("symolo", overrides), route, 1)


def run(route, *overrides):
    return simulate(spec_of(route, *overrides))


SEEDS = [*range(1, 7), *(pytest.param(seed, marks=pytest.mark.long) for seed in range(7, 21))]


@pytest.fixture(scope="module")
def laps(begun, request):
    """By route and seed, of the tests that are chosen."""
    items = [item for item in request.session.items if item.path == request.path and "laps" in item.fixturenames]
    cases = [(item.callspec.params["route"], item.callspec.params["seed"]) for item in items]
    return {(route, seed): begun(spec_of(route, f"seed={seed}")) for route, seed in cases}


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("route", STATES)
def test_a_lap_is_finished_without_touching_anything(route, seed, laps):
    outcome = laps[route, seed].result()
    assert outcome.problems == ()
    states = [state for state, _ in itertools.groupby(outcome.recording.trajectory.state)]
    assert states == STATES[route]
    pose = outcome.recording.trajectory.pose
    # The 2-D check of the reconstruction took about 39 s and 5.85 m.
    assert outcome.lap_time_s == pytest.approx(39, rel=0.1)
    assert np.hypot(*np.diff(pose[:, :2], axis=0).T).sum() == pytest.approx(5.85, rel=0.05)


def test_the_same_spec_gives_the_same_bytes():
    saved = []
    for _ in range(2):
        file = io.BytesIO()
        run("CCW", "stop.lap=false", "stop.time_limit_s=4").recording.save(file)
        saved.append(file.getvalue())
    assert saved[0] == saved[1]


def test_an_obstacle_too_low_to_be_seen_is_reported_as_touched():
    unseen = "arena.obstacles=[{name: Sill, center: [0.55, -0.6], size: [0.08, 0.08, 0.02]}]"
    outcome = run("CW", unseen)
    assert not outcome.finished
    assert outcome.problems == (f"touched Sill at {outcome.recording.trajectory.t_s[-1]:.2f} s",)


def test_a_wheel_far_beyond_the_speed_of_its_motor_ends_the_run_with_the_reason(monkeypatch):
    """A wheel without a rotor, and without the least inertia from `body`, is unstable. Its motor has 6 V / 0.6 V s."""
    motor = body._motor
    monkeypatch.setattr(body, "_motor", lambda *arguments: motor(*arguments[:-1], 0.0))
    strong = ("robot.motor.rotor_inertia_kg_m2=0", "robot.motor.torque_constant_N_m_A=0.6")
    outcome = run("CW", "stop.lap=false", "stop.time_limit_s=2", *strong)
    assert not outcome.finished
    assert re.fullmatch(
        r"a wheel turns at -?[0-9.]+ rad/s at [0-9.]+ s, and its motor reaches 10 rad/s without load: .*",
        outcome.problems[0],
    )


def test_a_lap_that_takes_too_long_is_reported():
    outcome = run("CW", "stop.time_limit_s=5")
    assert not outcome.finished
    assert "lap not finished within 5 s" in outcome.problems[0]
    assert outcome.problems[0].endswith("; to end all runs at stop.time_limit_s, set stop.lap=false")


def test_rows_come_at_20_hz_and_every_fourth_has_an_image():
    recording = run("CW", "stop.lap=false", "stop.time_limit_s=2").recording
    np.testing.assert_allclose(recording.trajectory.t_s, np.arange(41) * 0.05)
    image = recording["image"].values
    assert image.tolist()[:9] == [1, 0, 0, 0, 2, 0, 0, 0, 3]
    assert image.max() == 11


def test_odometry_and_encoders_agree_with_the_true_pose_on_a_short_run():
    recording = run("CW", "stop.lap=false", "stop.time_limit_s=4").recording
    pose, believed = recording.trajectory.pose, recording["odometry"].values
    travelled = np.hypot(*(pose[-1, :2] - pose[0, :2]))
    assert np.hypot(*believed[-1, :2]) == pytest.approx(travelled, abs=0.005)
    turned = pose[-1, 2] - pose[0, 2]
    assert believed[-1, 2] == pytest.approx(turned, abs=0.01)

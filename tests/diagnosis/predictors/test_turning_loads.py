"""Loads that come with the turning of a drive, against closed forms and a simulation of its own."""

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis
from diagnosis.inference.unexplained.adequacy import Adequacy
from diagnosis.inference.unexplained.unlisted import with_forms
from diagnosis.nominal_robot import nominal_robot
from diagnosis.nuisances import nuisances
from diagnosis.predictors.wheels.speeds import LOAD
from diagnosis.predictors.wheels.turning_loads import TURNING, turning_loads
from physics.effects.motor_and_gearbox.coulomb_friction_scale import CoulombFrictionScale
from tests.diagnosis.predictors.driven_wheels import (
    BASE,
    DAMPING,
    NOMINAL,
    RADIUS,
    ROW_S,
    SUPPLY_V,
    TC,
    J,
    K,
    R,
    wheels,
)


@pytest.fixture(scope="module")
def robot():
    return nominal_robot(NOMINAL, draw_robot(load_section("robot", "nominal"), 1, "test")[0])


def test_loads_slow_wheels_that_have_settled_by_their_torque_over_the_damping(robot):
    voltage_V = np.tile([1.5, 3.0], (60, 1))
    left, right = wheels(robot, voltage_V, np.zeros((60, 2))).observed
    lost = K / R * LOAD * SUPPLY_V / DAMPING
    expected = {
        "friction of a wheel that grows in turns": (-lost, -lost),
        "torque against the turn, in proportion to its rate": (lost, -lost),
        "friction against the turn": (lost, -lost),
    }
    by_name = [{e.what: e.response[50] for e in of.input_errors if e.covariate == TURNING} for of in (left, right)]
    for what, (of_left, of_right) in expected.items():
        np.testing.assert_allclose(by_name[0].pop(what), of_left, rtol=1e-4)
        np.testing.assert_allclose(by_name[1].pop(what), of_right, rtol=1e-4)
    assert by_name == [{}, {}]


def test_the_rate_of_turning_is_that_of_the_predicted_speeds(robot):
    voltage_V = np.tile([1.5, 3.0], (40, 1))
    for observed in wheels(robot, voltage_V, np.zeros((40, 2))).observed:
        (turning,) = (each for each in observed.covariates if each.name == TURNING)
        assert turning.values[30] == pytest.approx(RADIUS / BASE * K / R * 1.5 / DAMPING, rel=1e-6)


def test_wheels_that_never_turn_the_robot_have_no_such_load(robot):
    left, right = wheels(robot, np.tile([3.0, 3.0], (40, 1)), np.zeros((40, 2))).observed
    assert not [each for of in (left, right) for each in of.input_errors if each.covariate == TURNING]


def test_turns_that_only_voltages_have_do_not_count(robot):
    """A controller raises the voltage of a wheel that a bump slows down, without a commanded turn."""
    forward_m_s = np.repeat(np.random.default_rng(5).uniform(0.1, 0.4, 40), 15)
    bumps_V = np.repeat(np.random.default_rng(6).normal(0.0, 0.3, 120), 5)
    ahead_V = R / K * (DAMPING * forward_m_s / RADIUS + TC)
    voltage_V = np.stack([ahead_V - bumps_V, ahead_V + bumps_V], axis=-1)
    free = wheels(robot, voltage_V, np.zeros((600, 2)))
    led = wheels(robot, voltage_V, np.zeros((600, 2)), v_cmd_m_s=forward_m_s, w_cmd_rad_s=np.zeros(600))
    by_voltages, by_commands = (
        np.nanstd(next(c.values for c in of.observed[0].covariates if c.name == TURNING)) for of in (free, led)
    )
    assert by_commands < 0.3 * by_voltages


def driven(friction_N_m):
    """Voltages of a winding drive and the wheels' angles, by steps of 0.5 ms, with a friction by the speeds."""
    rows, steps = 600, 100
    voltage_V = np.repeat(np.random.default_rng(3).uniform(-1.0, 4.0, (rows // 15, 2)), 15, axis=0)
    angle_rad, speed, turned = np.zeros((rows, 2)), np.zeros(2), np.zeros(2)
    for row in range(rows):
        angle_rad[row] = turned
        for _ in range(steps):
            drive = K * voltage_V[row] / R - DAMPING * speed
            opposed = friction_N_m(speed) * np.tanh(speed / 0.01)
            speed = speed + ROW_S / steps / J * (drive - opposed)
            turned = turned + ROW_S / steps * speed
    return voltage_V, angle_rad


@pytest.mark.parametrize(
    ("friction_N_m", "along"),
    [(lambda w: TC * (1.0 + 0.3 * abs(w[1] - w[0])), [TURNING]), (lambda _: 2.5 * TC, [])],
    ids=["it grows in turns", "it is larger"],
)
def test_a_friction_that_grows_in_turns_takes_the_place_of_a_larger_friction(robot, friction_N_m, along):
    evidence = Evidence([wheels(robot, *driven(friction_N_m))])
    bare = Hypothesis(robot, nuisances(NOMINAL))
    named = bare.with_effect(CandidateEffect(CoulombFrictionScale))
    without, fit = fits(evidence, [(bare, bare.null()), (named, named.null())])
    assert without.cost - fit.cost > 50.0
    found = with_forms(evidence, without, fit, Adequacy(()))
    assert [s.covariate for s in found.structures if s.p < 0.001] == along


@pytest.mark.parametrize("difference", [0.0, 1e-12, 0.01])
def test_a_straight_drive_says_nothing_about_loads_in_turns(difference):
    speed_rad_s = 5.0 * np.sin(np.linspace(0.0, 6.0, 50))[:, None] * np.array([1.0, 1.0 + difference])
    assert list(turning_loads(speed_rad_s)) == []


def test_loads_are_against_the_turn_and_as_large_as_one():
    """The right wheel turns at 4 rad/s and the left one at 2 rad/s: a turn to the left, whose loads brake the right."""
    of_wheel, in_proportion, dry = (torque[0] for _, torque in turning_loads(np.array([[4.0, 2.0], [4.0, 3.0]])))
    assert of_wheel == pytest.approx([-1.0, -1.0])
    assert in_proportion == pytest.approx([-1.0, 1.0])
    assert dry == pytest.approx([-1.0, 1.0])

"""Counts that are lost at one angle of a wheel: closed forms, and drives whose wheels turn as is known."""

import math

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
from diagnosis.predictors.pose.by_counts import Pose
from diagnosis.predictors.pose.lost_counts import ANGLES, lost_counts
from physics.effects.wheels_and_floor.wheel_eccentricity import WheelEccentricity
from tests.diagnosis.predictors.driven_wheels import BASE, NOMINAL, RADIUS, ROW_S, TICKS, measured

ROWS = 600


def test_each_turn_of_a_wheel_passes_the_damage_once():
    """The right wheel turns by 2.5 turns in ten rows and back, the left one not at all."""
    turns = np.stack([np.append(np.linspace(0.0, 2.5, 11), np.linspace(2.25, 0.0, 10)), np.zeros(21)], axis=-1)
    responses = list(lost_counts(turns, (np.array([0, 10, 0]), np.array([10, 20, 20])), BASE))
    right, left = responses[:ANGLES], responses[len(responses) // 2 :]
    # From 0 to 2.5 turns, a damage at less than half a turn is passed once more.
    for number, (forward, to_left, turn) in enumerate(right[1:], start=1):
        passed = 3 if number <= ANGLES / 2 else 2
        np.testing.assert_array_equal(forward.response, [0.5 * passed, -0.5 * passed, 0.0])
        np.testing.assert_allclose(turn.response, np.array([passed, -passed, 0.0]) / BASE)
        assert not to_left.response.any()
    assert not any(each.response.any() for responses_of in left for each in responses_of)


@pytest.fixture(scope="module")
def robot():
    return nominal_robot(NOMINAL, draw_robot(load_section("robot", "nominal"), 1, "test")[0])


def drive(seed, lost_turns=0.0, amplitude=0.0):
    """Log of a drive in arcs. The right encoder loses a share of a turn at 1 rad, or the right wheel is eccentric."""
    random = np.random.default_rng(seed)
    speeds_rad_s = np.repeat(random.uniform(-9.0, 12.0, (ROWS // 20, 2)), 20, axis=0)
    before = np.concatenate([np.zeros((1, 2)), np.cumsum(ROW_S * speeds_rad_s, axis=0)])
    right_rad, left_rad = before.T
    rolled_m = RADIUS * np.stack([right_rad + amplitude * np.sin(right_rad + 1.0), left_rad], axis=-1)
    right_m, left_m = np.diff(rolled_m, axis=0).T
    turn_rad = (right_m - left_m) / BASE
    yaw_rad = np.append(0.0, np.cumsum(turn_rad))
    middle, forward_m = yaw_rad[:-1] + 0.5 * turn_rad, 0.5 * (right_m + left_m)
    lost_rad = math.tau * lost_turns * np.floor((right_rad - 1.0) / math.tau)
    noise = NOMINAL.noise
    columns = {
        "enc_right_ticks": np.floor(TICKS / math.tau * (right_rad - lost_rad)),
        "enc_left_ticks": np.floor(TICKS / math.tau * left_rad),
        "x_m": np.append(0.0, np.cumsum(forward_m * np.cos(middle))) + random.normal(0.0, noise.pose_xy_m, ROWS + 1),
        "y_m": np.append(0.0, np.cumsum(forward_m * np.sin(middle))) + random.normal(0.0, noise.pose_xy_m, ROWS + 1),
        "theta_rad": yaw_rad + random.normal(0.0, noise.pose_theta_rad, ROWS + 1),
    }
    return measured(ROW_S * np.arange(ROWS + 1), columns)


@pytest.mark.parametrize(
    ("fault", "along"),
    [({"lost_turns": 0.015}, ["wheel_angle_rad[right]"]), ({"amplitude": 0.03}, [])],
    ids=["lost counts", "eccentric wheel"],
)
@pytest.mark.parametrize("seed", [863, 864])
def test_lost_counts_take_the_place_of_an_eccentric_wheel_and_not_the_other_way_round(robot, seed, fault, along):
    evidence = Evidence([Pose(drive(seed, **fault), robot)])
    bare = Hypothesis(robot, nuisances(NOMINAL))
    (without,) = fits(evidence, [(bare, bare.null())])
    named = bare.with_effect(CandidateEffect(WheelEccentricity, (("side", "right"),)))
    # The amplitude and the phase [rad], from several phases.
    starts = [np.append(without.x, [at, phase]) for at in (0.2, 1.0) for phase in (-2.0, -0.5, 1.0, 2.5)]
    fit = min(fits(evidence, [(named, start) for start in starts]), key=lambda each: each.cost)
    assert without.cost - fit.cost > 30.0
    structures = with_forms(evidence, without, fit, Adequacy(())).structures
    assert [each.covariate for each in structures if each.p < 0.001] == along

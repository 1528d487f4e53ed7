"""Motion that wheels lose by slip: closed forms, and drives that are integrated in steps of a millisecond."""

import math

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import Hypothesis
from diagnosis.inference.unexplained.adequacy import LEVEL, adequacy
from diagnosis.nominal_robot import nominal_robot
from diagnosis.nuisances import nuisances
from diagnosis.predictors.pose.by_counts import Pose
from diagnosis.predictors.pose.wheel_slip import ACCELERATION, FORWARD, TURN, CountedMotion, slip_functions
from tests.diagnosis.predictors.driven_wheels import BASE, NOMINAL, RADIUS, ROW_S, TICKS, measured

ROWS, STEPS, STEP_S = 800, 50, 0.001
SETTLES_S = 0.1
"""Time constant of the wheels behind their set speeds."""
COUNT_M = math.tau * RADIUS / TICKS


def motion(travel_m, poses=None, trials=1):
    """Motion of rows with changes of the pose over ten rows each."""
    rows = len(travel_m) // trials
    first = np.concatenate([np.arange(k * rows, (k + 1) * rows - 10, 5) for k in range(trials)])
    poses = np.full((len(travel_m), 3), np.nan) if poses is None else poses
    starts = np.arange(trials) * rows
    return CountedMotion(travel_m, np.full(len(travel_m), ROW_S), poses, starts, (first, first + 10), BASE, COUNT_M)


def test_what_one_wheel_loses_turns_the_robot_and_what_both_lose_stops_it():
    lost_m = np.zeros((40, 2))
    lost_m[7] = [0.02, 0.0]
    lost_m[23] = [0.01, 0.01]
    forward, turn = (motion(np.zeros((40, 2))).changed(lost_m, component) for component in (FORWARD, TURN))
    # The changes of the pose begin in the rows 0, 5, ... 25, and the motion of their first row is before them.
    np.testing.assert_allclose(forward, [0.01, 0.01, 0.0, 0.01, 0.01, 0.0], atol=1e-15)
    np.testing.assert_allclose(turn, [0.02 / BASE, 0.02 / BASE, 0.0, 0.0, 0.0, 0.0], atol=1e-15)


def test_wheels_that_speed_up_and_brake_are_apart():
    """From rest, the speed rises by 2 mm a row in each of 30 rows, and falls as fast afterwards; backwards likewise."""
    speeds = np.concatenate([np.arange(30), np.arange(30, 0, -1)]) * 0.002
    travel_m = np.tile(np.concatenate([speeds, -speeds])[:, None], (1, 2))
    of = motion(travel_m)
    _, (covariate,) = slip_functions(of, FORWARD)
    assert covariate.name == ACCELERATION
    proportional, *beyond = covariate.functions
    driven_m = of.changed(travel_m, FORWARD)
    speeds_up = [0, 1, 2, 3, 12, 13, 14, 15]
    brakes = [6, 7, 8, 9, 18, 19, 20]
    for functions in beyond:
        np.testing.assert_allclose(
            functions[speeds_up], np.stack([driven_m[speeds_up], np.zeros(8)], axis=-1), atol=1e-12
        )
        np.testing.assert_allclose(functions[brakes], np.stack([np.zeros(7), driven_m[brakes]], axis=-1), atol=1e-12)
    # The acceleration is constant, so that a share of all travel is lost.
    ratio = proportional[speeds_up, 0] / driven_m[speeds_up]
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-9)


@pytest.mark.parametrize("travel_m", [np.zeros((60, 2)), np.full((60, 2), 0.01)], ids=["still", "steady"])
def test_without_acceleration_nothing_depends_on_it(travel_m):
    """A steady drive accelerates in its first row only."""
    _, covariates = slip_functions(motion(travel_m), FORWARD)
    for covariate in covariates:
        assert all(np.count_nonzero(functions.any(axis=-1)) <= 2 for functions in covariate.functions)


def test_slip_hardly_moves_a_robot_to_the_side_and_unknown_places_have_no_patches():
    travel_m = np.random.default_rng(1).normal(0.01, 0.005, (60, 2))
    assert slip_functions(motion(travel_m), 1) == ((), ())
    assert slip_functions(motion(travel_m), TURN)[0] == ()


def test_a_robot_that_is_carried_far_with_wheels_that_hardly_turn_has_no_patches():
    """Patches as small as its travel would be thousands of millions in this room."""
    travel_m = np.zeros((60, 2))
    travel_m[7:40:11] = 1.2 * COUNT_M
    poses = np.zeros((60, 3))
    poses[30:, :2] = [20.0, 10.0]
    assert slip_functions(motion(travel_m, poses), TURN)[0] == ()


@pytest.fixture(scope="module")
def robot():
    return nominal_robot(NOMINAL, draw_robot(load_section("robot", "nominal"), 1, "test")[0])


def drive(seed, lost_share):
    """Log of a drive that stays within 0.5 m of its start.

    Args:
        seed: Of the set speeds and of the noise.
        lost_share: Function of places (2, 2) and accelerations (2,) of both rims, that returns what they lose (2,).
    """
    random = np.random.default_rng(seed)
    speed_m_s, pose, angle_rad = np.zeros(2), np.zeros(3), np.zeros(2)
    aim_m_s, rows = np.zeros(2), []
    for row in range(ROWS):
        rows.append([*angle_rad, *pose])
        if row % 15 == 0:
            ahead = random.uniform(-0.3, 0.3)
            # Homewards where it is far out.
            if np.hypot(*pose[:2]) > 0.4:
                ahead = math.copysign(ahead, -(pose[0] * math.cos(pose[2]) + pose[1] * math.sin(pose[2])))
            aim_m_s = ahead + 0.5 * BASE * random.uniform(-2.0, 2.0) * np.array([1.0, -1.0])
        for _ in range(STEPS):
            rate_m_s2 = (aim_m_s - speed_m_s) / SETTLES_S
            speed_m_s = speed_m_s + STEP_S * rate_m_s2
            angle_rad = angle_rad + STEP_S * speed_m_s / RADIUS
            to_left = 0.5 * BASE * np.array([-math.sin(pose[2]), math.cos(pose[2])])
            places = np.array([pose[:2] - to_left, pose[:2] + to_left])
            right, left = STEP_S * speed_m_s * (1.0 - lost_share(places, rate_m_s2 * np.sign(speed_m_s)))
            turn = (right - left) / BASE
            middle = pose[2] + 0.5 * turn
            forward = 0.5 * (right + left)
            pose = pose + np.array([forward * math.cos(middle), forward * math.sin(middle), turn])
    right_rad, left_rad, x_m, y_m, theta_rad = np.array(rows).T
    noise = NOMINAL.noise
    columns = {
        "enc_right_ticks": np.floor(TICKS / math.tau * right_rad),
        "enc_left_ticks": np.floor(TICKS / math.tau * left_rad),
        "x_m": x_m + random.normal(0.0, noise.pose_xy_m, ROWS),
        "y_m": y_m + random.normal(0.0, noise.pose_xy_m, ROWS),
        "theta_rad": theta_rad + random.normal(0.0, noise.pose_theta_rad, ROWS),
    }
    return measured(ROW_S * np.arange(ROWS), columns)


NEITHER, LEFT, BOTH = np.array([0.0, 0.0]), np.array([0.0, 1.0]), np.array([1.0, 1.0])


def slipping(on_patch=NEITHER, speeding_up=NEITHER):
    """The right and the left wheel lose 6 % on a patch, and 15 % beyond an acceleration of 0.6 m/s2."""

    def lost_share(places_m, acceleration_m_s2):
        is_inside = np.hypot(*(places_m - [0.1, 0.05]).T) < 0.12
        return 0.06 * on_patch * is_inside + 0.15 * speeding_up * (acceleration_m_s2 > 0.6)

    return lost_share


@pytest.mark.parametrize("seed", [861, 862])
@pytest.mark.parametrize(
    ("lost_share", "along"),
    [
        (slipping(), None),
        (slipping(on_patch=BOTH), "position"),
        (slipping(on_patch=LEFT), "position"),
        (slipping(speeding_up=BOTH), ACCELERATION),
    ],
    ids=["nothing", "patch", "patch under the left wheel", "speeding up"],
)
def test_slip_is_seen_along_its_cause(robot, seed, lost_share, along):
    evidence = Evidence([Pose(drive(seed, lost_share), robot)])
    bare = Hypothesis(robot, nuisances(NOMINAL))
    (fit,) = fits(evidence, [(bare, bare.null())])
    strongest = adequacy(evidence, fit).worst
    assert (strongest.covariate if strongest.p < LEVEL else None) == along

"""The controller in C beside the one in Python, which is the reference, on the same readings tick by tick."""

import copy
import math

import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from physics.control.paths import straight_path
from pipeline.stages.simulate import simulate
from symolo.dataset.codes import State

pytestmark = pytest.mark.compiler

FLOAT = 2e-5
"""What single precision makes of a few operations on numbers up to 10."""
SPACING_M = 0.4e-3
"""No shipped path has its points further apart."""
MAX_OFF = 2
"""Points by which the nearest one may differ."""


def assert_alike(robot, reference, tried):
    """Same states and counters at every tick, and commands that differ by no more than the numbers' rounding.

    Returns the share of ticks whose commands could be compared.

    Off the paths a command is a few operations on floats of 24 bits. On a path the goal may be one of the points beside
    the reference's, and its coordinates are rounded to half of 2^-15 m each. The curvature 2 y / (x^2 + y^2) towards a
    goal (x, y) changes by 2 / (x^2 + y^2) per metre that the goal moves, in whatever direction.
    """
    expected, got = ({name: np.array(value) for name, value in vars(drive).items()} for drive in (reference, tried))
    same = got["state"] == expected["state"]
    assert_early_or_late_by_rounding(same, expected["nearest"], robot.controller.avoidance)
    assert np.abs(got["line_lost"] - expected["line_lost"]).max() <= np.sum(~same)
    np.testing.assert_allclose(got["odometry"], expected["odometry"], rtol=0, atol=5e-6)
    off = np.where(same, np.abs(got["nearest"] - expected["nearest"]), 0)
    assert off.max() <= MAX_OFF
    distance_m, bearing = expected["goal"].T
    moved_m = SPACING_M * off + math.sqrt(0.5) * 2.0**-15
    curvature = np.where(expected["nearest"] >= 0, 2.0 * moved_m / (distance_m - moved_m) ** 2, 0.0)
    clear = same & ~at_a_turn(robot, bearing, moved_m / distance_m)
    v_m_s, w_rad_s = np.abs(expected["motion"]).T
    # On a curve path the speed is at most the highest yaw rate over the curvature.
    share = np.minimum(curvature * v_m_s / np.maximum(w_rad_s, 1e-9), 1.0 - 1e-9)
    slower = np.minimum(v_m_s * share / (1.0 - share), robot.controller.avoidance.speed_m_s)
    apart = np.abs(got["motion"] - expected["motion"])
    assert np.all(apart[clear, 0] <= 1.1 * slower[clear] + FLOAT)
    assert np.all(apart[clear, 1] <= 1.1 * (v_m_s * curvature)[clear] + FLOAT)
    return clear.mean()


def assert_early_or_late_by_rounding(same, nearest, avoidance):
    """A state may change one tick apart only where the path's nearest point is at the limit of that change."""
    limits = (straight_path(avoidance, "left").back_begins, avoidance.points - 2)
    for tick in np.flatnonzero(~same):
        assert same[tick - 1]
        assert same[tick + 1]
        at_limit = [abs(nearest[tick - 1] - limit) <= MAX_OFF for limit in limits]
        assert any(at_limit), f"tick {tick}"


def at_a_turn(robot, bearing, turned_rad):
    """Where a path's goal lies on the limit between driving and turning, or straight behind the robot, or under it."""
    curves = robot.controller.avoidance.curves
    limits = (math.pi,) if curves is None else (math.pi, curves.turn_above_rad)
    at_limit = [np.abs(np.abs(bearing) - limit) < 1.1 * turned_rad + 1e-4 for limit in limits]
    return np.any(at_limit, axis=0) | (turned_rad > 0.3)


def test_both_do_the_same_on_random_readings(robot, library, random_drive):
    rng = np.random.Generator(np.random.PCG64(2))
    seen, compared, in_c = set(), [], library(robot)
    for _ in range(10):
        drive = random_drive(robot, 300, rng)
        compared.append(assert_alike(robot, drive, in_c.drive(drive)))
        seen |= set(drive.state)
    assert seen == set(State)
    assert np.mean(compared) > 0.9


LIMITS_MM = (140, 150, 200, 270, 300, 340, 350, 370, 420)
"""At which the shipped robots decide by a range."""
BEGINNINGS_MM = ((2000, 2000, 2000), (2000, 2000, 300), (2000, 300, 2000))
"""After which the robot follows the line, the wall to its right, the wall to its left."""


def test_both_decide_alike_at_and_beside_every_limit_of_a_range(robot, library, reference):
    rng = np.random.Generator(np.random.PCG64(2))
    fresh, in_c = reference(robot), library(robot)
    seen = set()
    for drive in range(90):
        python = copy.deepcopy(fresh)
        python.step([0, 0], [230] * 8, BEGINNINGS_MM[drive % 3])
        for _ in range(6):
            ranges_mm = rng.choice(LIMITS_MM, 3) + rng.integers(-1, 2, 3)
            python.step([100, 100], [230] * 8, ranges_mm.tolist())
        assert in_c.drive(python.drive).state.tolist() == python.drive.state
        seen |= set(python.drive.state)
    assert len(seen) >= 7


def test_the_nearest_point_is_found_from_far_off_too(robot, library, reference):
    """Points rounded by q, with a robot D off the path, leave the nearest one open by sqrt(4 D q)."""
    rng = np.random.Generator(np.random.PCG64(5))
    spacing_m, max_m = straight_path(robot.controller.avoidance, "left").spacing_m, 0.4
    fresh, in_c = reference(robot), library(robot)
    farthest = 0
    for _ in range(10):
        python = copy.deepcopy(fresh)
        python.step([0, 0], [230] * 8, [2000, 2000, 300])
        python.step([0, 0], [230] * 8, [190, 2000, 300])
        for _ in range(10):
            python.step((rng.integers(200, 700) + rng.integers(-60, 60, 2)).tolist(), [230] * 8, [2000] * 3)
        expected = np.array(python.drive.nearest[1:])
        off = np.abs(in_c.drive(python.drive).nearest[1:] - expected)
        assert np.all(off <= 2 + math.sqrt(4.0 * max_m * math.sqrt(0.5) * 2.0**-15) / spacing_m)
        farthest = max(farthest, expected[-1])
    assert farthest > 500


def on_the_wire(readings, counts_before):
    counts = np.array(readings["encoders"])
    line, ranges_mm = np.rint(255 * readings["line"]), np.rint(1000 * readings["tof"][:, 0])
    return counts, ((counts - counts_before).tolist(), line.astype(int).tolist(), ranges_mm.astype(int).tolist())


@pytest.mark.firmware
@pytest.mark.parametrize(
    ("scenario", "route"),
    [("symolo", "CW"), ("symolo", "CCW"), ("classroom", "CW"), ("classroom", "CCW"), ("wall_gaps", "East")],
)
def test_both_do_the_same_on_the_readings_of_a_simulated_lap(library, reference, scenario, route):
    spec = draw_run(load_scenario(scenario), route, 1)
    recording = simulate(spec).recording
    controller, counts = reference(spec.robot), np.zeros(2, dtype=int)
    for tick in range(len(recording.trajectory.t_s)):
        names = {"line": "line", "encoders": "encoder_counts"}
        readings = {name: recording[series].values[tick] for name, series in names.items()}
        readings["tof"] = recording["tof_m"].values[tick][:, None]
        counts, received = on_the_wire(readings, counts)
        controller.step(*received)
    assert controller.drive.state == recording.trajectory.state.tolist()
    assert assert_alike(spec.robot, controller.drive, library(spec.robot).drive(controller.drive)) > 0.97

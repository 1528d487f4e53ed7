"""Curve paths: their shape, and which of them is chosen from ranges and the recent path."""

import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from physics.control.base import Observation
from physics.control.bends import BendMemory, curve_pass
from physics.control.paths import curve_path

WHITE = (0.9,) * 8
NOTHING = 2.0


@pytest.fixture(scope="module")
def avoidance():
    return draw_run(load_scenario("classroom"), "CCW", 1).robot.controller.avoidance


@pytest.fixture
def bends(avoidance):
    return BendMemory(avoidance.curves.memory_m, avoidance.curves.straight_below_rad)


def seen(front=NOTHING, left=NOTHING, right=NOTHING):
    return Observation(WHITE, front, left, right, (0.0, 0.0, 0.0))


def drive_arc(bends, turn):
    """A quarter circle of 0.15 m, to the left for +1."""
    for angle in np.linspace(0.0, np.pi / 2, 30):
        bends.update((0.15 * np.sin(angle), turn * 0.15 * (1 - np.cos(angle)), turn * angle))


def drive_on(bends, turn):
    for along in np.linspace(0.0, 0.2, 20):
        bends.update((0.15, turn * (0.15 + along), turn * np.pi / 2))


@pytest.mark.parametrize("variant", ["inner", "outer"])
def test_a_curve_path_has_3200_even_points_through_its_control_points(avoidance, variant):
    config = getattr(avoidance.curves, variant)
    path = curve_path(config, avoidance.points, "left")
    assert path.points.shape == (3200, 2)
    assert np.hypot(*np.diff(path.points, axis=0).T) == pytest.approx(path.spacing_m, rel=1e-3)
    for knot in config.points:
        assert np.hypot(*(path.points - knot).T).min() < path.spacing_m


@pytest.mark.parametrize("variant", ["inner", "outer"])
def test_the_other_bend_has_the_mirrored_path(avoidance, variant):
    config = getattr(avoidance.curves, variant)
    left, right = (curve_path(config, 3200, bend).points for bend in ("left", "right"))
    np.testing.assert_array_equal(left * (1, -1), right)


def test_inner_passes_on_the_side_of_the_bend_and_outer_on_the_other(avoidance):
    # The cube's middle is 0.335 m ahead: sensor at 0.085 m, reading 0.20 m, half a cube of 0.1 m.
    for variant, sign in (("inner", 1.0), ("outer", -1.0)):
        points = curve_path(getattr(avoidance.curves, variant), 3200, "left").points
        first = points[np.argmax(points[:, 0] >= 0.335)]
        assert np.sign(first[1]) == sign
        # Half the robot's width and half the cube's diagonal.
        assert np.hypot(*(points - (0.335, 0.0)).T).min() > 0.085 + 0.0707


@pytest.mark.parametrize(("turn", "inside"), [(1, "left"), (-1, "right")])
def test_straight_ahead_the_inside_is_taken(bends, avoidance, turn, inside):
    drive_arc(bends, turn)
    chosen = curve_pass(seen(front=0.19), bends, avoidance)
    assert (chosen.side, chosen.variant, chosen.bend) == (inside, "inner", inside)


@pytest.mark.parametrize(("turn", "inside", "outside"), [(1, "left", "right"), (-1, "right", "left")])
def test_beside_the_robot_the_recent_path_decides(bends, avoidance, turn, inside, outside):
    drive_arc(bends, turn)
    in_bend = curve_pass(seen(**{inside: 0.19}), bends, avoidance)
    assert (in_bend.side, in_bend.variant) == (inside, "inner")
    drive_on(bends, turn)
    before_bend = curve_pass(seen(**{inside: 0.19}), bends, avoidance)
    assert (before_bend.side, before_bend.variant, before_bend.bend) == (outside, "outer", inside)


def test_what_stands_outside_the_bend_is_no_obstacle(bends, avoidance):
    drive_arc(bends, 1)
    assert curve_pass(seen(right=0.10), bends, avoidance) is None


def test_between_two_beams_it_shows_in_both(bends, avoidance):
    drive_arc(bends, 1)
    drive_on(bends, 1)
    assert curve_pass(seen(front=0.36, left=0.36), bends, avoidance).variant == "outer"
    assert curve_pass(seen(front=0.36, left=0.38), bends, avoidance) is None

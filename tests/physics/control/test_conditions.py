"""Conditions at their limits, which configs/schema/controller.py says: below, above, within, from."""

import pytest

from physics.control.base import Observation
from physics.control.bends import CurvePass
from physics.control.conditions import CONDITIONS, Condition, ControlView
from symolo.dataset.codes import State

STEP_M = 1e-6


@pytest.fixture
def holds(robot):
    def holds(condition, argument="", line_error=None, front=2.0, curve=None, **sides):
        ranges = {"left": 2.0, "right": 2.0} | sides
        seen = Observation((0.9,) * 8, front, ranges["left"], ranges["right"], (0.0, 0.0, 0.0))
        view = ControlView(seen, robot.controller, line_error, None, State.LINE, curve)
        return CONDITIONS[condition].holds(view, argument)

    return holds


@pytest.mark.parametrize(("side", "opposite"), [("left", "right"), ("right", "left")])
def test_a_wall_is_found_below_one_range_and_lost_above_another(holds, robot, side, opposite):
    found, lost = robot.controller.wall.found_within_m, robot.controller.wall.lost_beyond_m
    assert holds("line_ended_by_wall", side, **{side: found - STEP_M})
    assert not holds("line_ended_by_wall", side, **{side: found})
    assert not holds("line_ended_by_wall", side, line_error=0.0, **{side: found - STEP_M})
    assert holds("wall_lost", side, **{side: lost + STEP_M})
    assert not holds("wall_lost", side, **{side: lost})
    assert holds("wall_back", side, **{side: lost})
    assert not holds("wall_back", side, **{side: lost + STEP_M})
    assert holds("wall_goes_on_opposite", side, **{side: lost + STEP_M, opposite: found - STEP_M})
    assert not holds("wall_goes_on_opposite", side, **{side: lost, opposite: found - STEP_M})
    assert not holds("wall_goes_on_opposite", side, **{side: lost + STEP_M, opposite: found})


@pytest.mark.parametrize("side", ["left", "right"])
def test_an_obstacle_is_below_one_range_ahead_and_its_side_is_free_from_another_on(holds, robot, side):
    avoid = robot.controller.avoidance
    below, free = avoid.front_below_m - STEP_M, avoid.free_side_beyond_m
    assert holds("obstacle_ahead", side, front=below, **{side: free})
    assert not holds("obstacle_ahead", side, front=avoid.front_below_m, **{side: free})
    assert not holds("obstacle_ahead", side, front=below, **{side: free - STEP_M})


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_corner_begins_below_one_range_and_ends_above_another_beside_a_wall(holds, robot, side):
    corner, found = robot.controller.corner, robot.controller.wall.found_within_m
    assert holds("corner_ahead", front=corner.front_below_m - STEP_M)
    assert not holds("corner_ahead", front=corner.front_below_m)
    assert holds("corner_turned", side, front=corner.front_clear_m + STEP_M, **{side: found - STEP_M})
    assert not holds("corner_turned", side, front=corner.front_clear_m, **{side: found - STEP_M})
    assert not holds("corner_turned", side, front=corner.front_clear_m + STEP_M, **{side: found})


def test_a_line_with_an_error_of_zero_is_seen(holds):
    assert holds("on_line", line_error=0.0)
    assert not holds("on_line", line_error=None)


def test_a_curve_path_is_taken_on_its_own_side(holds):
    curve = CurvePass(side="left", variant="inner", bend="right", near_m=0.2)
    assert [holds("curve_beside", side, curve=curve) for side in ("left", "right")] == [True, False]
    assert not holds("curve_beside", "left")


@pytest.mark.parametrize("condition", ["line_met_on_the_way_back", "avoided"])
def test_without_a_path_none_is_driven_back_or_to_its_end(holds, condition):
    assert not holds(condition, "LINE", line_error=0.0)


def test_a_condition_and_what_it_sees_cannot_be_changed(changeable):
    for kind in (ControlView, Condition):
        assert changeable(kind) == []

"""Which state follows which: the rules of SPEC section 4, one situation each."""

import math

import pytest

from physics.control.base import ControllerSettings, Observation
from physics.control.built_in import BuiltIn
from symolo.core.random_streams import stream
from symolo.dataset.codes import State

WHITE = (0.9,) * 8
ON_LINE = (0.9, 0.9, 0.9, 0.1, 0.1, 0.9, 0.9, 0.9)
NOTHING = 2.0
WALL = 0.17  # the target distance of 0.12 m seen at 45 degrees


def seen(line=WHITE, front=NOTHING, left=NOTHING, right=NOTHING, at=(0.0, 0.0, 0.0)):
    return Observation(line, front, left, right, at)


@pytest.fixture
def controller(robot):
    return BuiltIn(ControllerSettings(), robot, 20, stream(1))


@pytest.fixture
def following(controller):
    """Bring the controller into a wall state by way of the end of a line."""

    def bring(side):
        controller.step(seen(ON_LINE))
        command = controller.step(seen(**{side: WALL}))
        assert command.state is {"left": State.LEFT_WALL, "right": State.RIGHT_WALL}[side]
        return controller

    return bring


def test_state_numbers_are_those_of_the_data_set():
    assert {state.name: int(state) for state in State} == {
        "LINE": 0,
        "RIGHT_WALL": 1,
        "LEFT_WALL": 2,
        "TURN_LEFT": 3,
        "TURN_RIGHT": 4,
        "AVOID_LEFT": 5,
        "AVOID_RIGHT": 6,
        "LOST_LEFT_WALL": 33,
        "LOST_RIGHT_WALL": 44,
    }


def test_without_line_and_wall_the_last_line_error_is_held_and_counted(controller):
    to_the_left = (0.9,) * 6 + (0.1, 0.1)
    first = controller.step(seen(to_the_left))
    second = controller.step(seen(WHITE))
    assert first.w_rad_s > 0
    assert (second.v_m_s, second.w_rad_s, second.state) == (first.v_m_s, first.w_rad_s, State.LINE)
    assert controller.line_lost_count == 1


@pytest.mark.parametrize(("side", "state"), [("right", State.RIGHT_WALL), ("left", State.LEFT_WALL)])
def test_where_the_line_ends_a_wall_takes_over(controller, side, state):
    controller.step(seen(ON_LINE))
    assert controller.step(seen(**{side: WALL})).state is state


def test_a_wall_beside_the_line_does_not_matter_while_the_line_is_seen(controller):
    assert controller.step(seen(ON_LINE, right=WALL)).state is State.LINE


@pytest.mark.parametrize("side", ["left", "right"])
def test_line_seen_again_ends_wall_following(following, side):
    assert following(side).step(seen(ON_LINE, **{side: WALL})).state is State.LINE


@pytest.mark.parametrize(("side", "sign"), [("right", 1.0), ("left", -1.0)])
def test_too_close_to_the_wall_turns_away_from_it(following, side, sign):
    command = following(side).step(seen(**{side: 0.8 * WALL}))
    assert math.copysign(1.0, command.w_rad_s) == sign


@pytest.mark.parametrize(
    ("side", "free", "state"), [("right", "left", State.AVOID_LEFT), ("left", "right", State.AVOID_RIGHT)]
)
def test_an_obstacle_on_the_way_is_avoided_on_the_free_side(following, side, free, state):
    assert following(side).step(seen(front=0.19, **{side: WALL, free: 0.42})).state is state


@pytest.mark.parametrize(("side", "state"), [("right", State.TURN_LEFT), ("left", State.TURN_RIGHT)])
def test_a_wall_ahead_with_no_free_side_is_a_corner(following, side, state):
    other = "left" if side == "right" else "right"
    controller = following(side)
    assert controller.step(seen(front=0.16, **{side: WALL, other: 0.30})).state is not state
    command = controller.step(seen(front=0.14, **{side: WALL, other: 0.30}))
    assert command.state is state
    assert command.v_m_s == 0.0
    assert math.copysign(1.0, command.w_rad_s) == (1.0 if state is State.TURN_LEFT else -1.0)
    still = controller.step(seen(front=0.20, **{side: WALL}))
    assert still.state is state
    turned = controller.step(seen(front=0.60, **{side: WALL}))
    assert turned.state is {"right": State.RIGHT_WALL, "left": State.LEFT_WALL}[side]


@pytest.mark.parametrize(("side", "state"), [("right", State.LEFT_WALL), ("left", State.RIGHT_WALL)])
def test_where_a_wall_ends_the_one_on_the_other_side_takes_over(following, side, state):
    other = "left" if side == "right" else "right"
    assert following(side).step(seen(**{side: 0.36, other: WALL})).state is state


@pytest.mark.parametrize(
    ("side", "lost", "sign"), [("left", State.LOST_LEFT_WALL, 1.0), ("right", State.LOST_RIGHT_WALL, -1.0)]
)
def test_a_lost_wall_is_looked_for_on_its_side_and_found_again(following, side, lost, sign):
    controller = following(side)
    command = controller.step(seen(**{side: 0.36}))
    assert command.state is lost
    assert math.copysign(1.0, command.w_rad_s) == sign
    assert controller.step(seen()).state is lost
    assert controller.step(seen(**{side: 0.30})).state is {"left": State.LEFT_WALL, "right": State.RIGHT_WALL}[side]


def test_a_lost_wall_may_go_on_beyond_a_gap_before_the_robot_turns_round_its_end(following, robot):
    controller, lost = following("right"), robot.controller.lost
    rates = {}
    for x in (0.0, 0.20, lost.gap_m + 0.01):
        rates[x] = controller.step(seen(right=0.36, at=(x, 0.0, 0.0))).w_rad_s
    assert list(rates.values()) == [-lost.gap_turn_rate_rad_s, -lost.gap_turn_rate_rad_s, -lost.turn_rate_rad_s]


def drive_past(controller, front_first, **beside):
    """Let the robot run its avoidance path ideally; returns the states it was in."""
    x = y = yaw = 0.0
    states = []
    for tick in range(200):
        command = controller.step(seen(front=front_first if tick == 0 else NOTHING, at=(x, y, yaw), **beside))
        states.append(command.state)
        if tick and command.state not in {State.AVOID_LEFT, State.AVOID_RIGHT}:
            break
        x += 0.05 * command.v_m_s * math.cos(yaw)
        y += 0.05 * command.v_m_s * math.sin(yaw)
        yaw += 0.05 * command.w_rad_s
    return states, (x, y, yaw)


def test_beside_a_wall_the_path_is_driven_to_its_end_and_the_wall_taken_up_again(following):
    states, (x, y, _) = drive_past(following("right"), 0.19)
    assert states[0] is State.AVOID_LEFT
    assert states[-1] is State.RIGHT_WALL
    assert (x, y) == pytest.approx((0.68, 0.0), abs=0.03)


def test_on_a_line_the_left_is_tried_first_and_the_right_where_it_is_blocked(robot):
    for left, state in ((NOTHING, State.AVOID_LEFT), (0.3, State.AVOID_RIGHT)):
        controller = BuiltIn(ControllerSettings(), robot, 20, stream(1))
        assert controller.step(seen(ON_LINE, front=0.19, left=left)).state is state


def test_the_line_counts_only_on_the_way_back(controller):
    controller.step(seen(ON_LINE, front=0.19))
    assert controller.step(seen(ON_LINE, at=(0.05, 0.01, 0.3))).state is State.AVOID_LEFT
    x = y = yaw = 0.0
    for _ in range(200):
        command = controller.step(seen(ON_LINE if x > 0.5 else WHITE, at=(x, y, yaw)))
        if command.state is State.LINE:
            break
        x += 0.05 * command.v_m_s * math.cos(yaw)
        y += 0.05 * command.v_m_s * math.sin(yaw)
        yaw += 0.05 * command.w_rad_s
    assert command.state is State.LINE
    assert 0.5 < x < 0.6

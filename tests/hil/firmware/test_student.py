"""The part that students write: what is left of student.c for them, and that the library takes what they write."""

import pytest

from hil.build import student_tasks, student_version
from symolo.core.errors import InputError
from symolo.dataset.codes import State


def test_the_functions_to_be_written_are_those_of_the_paper():
    assert student_tasks() == ("line_error", "wall_error", "follow", "wheel_speeds", "next_state")


def test_what_is_to_be_written_holds_no_solution_and_the_rest_holds_it():
    text = student_version(["follow", "next_state"])
    assert text.count("TODO") == 2
    assert "#if" not in text
    assert "#else" not in text
    assert "k2_rad_s * error" not in text
    assert "next_by_table" not in text
    assert "transitions.h" not in text
    assert "WALL_TARGET_DISTANCE_M - actual_m" in text


def test_a_function_that_there_is_not_is_refused():
    with pytest.raises(InputError, match="got 'folow', allowed: one of line_error, wall_error, follow"):
        student_version(["folow"])


NEXT_STATE = """\
    if (state == STATE_LINE && obstacle_ahead(view, SIDE_LEFT))
        return STATE_AVOID_LEFT;
    if (state == STATE_AVOID_LEFT && (avoided(view, STATE_LINE) || line_met_on_the_way_back(view)))
        return STATE_LINE;
    return state;
"""


@pytest.mark.compiler
@pytest.mark.firmware
def test_a_student_s_own_states_drive_the_robot(robot_of, library, reference, wheel_counts):
    robot = robot_of("nominal")
    todo = student_version(["next_state"])
    text = todo[: todo.index("    /* TODO")] + NEXT_STATE + "}\n"
    python, command = reference(robot), None
    for tick in range(150):
        counts = [0, 0] if command is None else wheel_counts(robot, command).round().astype(int).tolist()
        white = [230] * 8
        command = python.step(counts, white, [190 if tick == 3 else 2000, 2000, 2000])
    assert set(python.drive.state) == {State.LINE, State.AVOID_LEFT}
    assert python.drive.state[-1] == State.LINE
    assert library(robot, student=text).drive(python.drive).state.tolist() == python.drive.state


@pytest.mark.compiler
@pytest.mark.firmware
def test_a_robot_of_which_nothing_is_written_stands_still(robot_of, library, reference):
    robot = robot_of("nominal")
    python = reference(robot)
    for _ in range(3):
        python.step([0, 0], [20] * 8, [190, 2000, 2000])
    still = library(robot, student=student_version(student_tasks())).drive(python.drive)
    assert still.state.tolist() == [0, 0, 0]
    assert not still.motion.any()

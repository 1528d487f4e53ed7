"""What is made of the robot's configuration for the firmware, beside the controller in Python."""

import re

import numpy as np
import pytest

from configs.loader import RobotAlone, load_section
from configs.validation.values import validated
from hil.generate import generate
from physics.control.paths import curve_path, straight_path
from physics.control.transitions import load_transitions
from symolo.core.errors import InputError


def robot_of(name, *settings):
    return validated(load_section("robot", name, settings).root, RobotAlone, {}).robot


@pytest.fixture(scope="module")
def classroom():
    return robot_of("classroom")


@pytest.fixture(scope="module")
def made(classroom):
    return generate(classroom)


def constants(text):
    return {
        name: float(value.rstrip("f"))
        for name, value in re.findall(r"^#define (\w+) ([-\d.e]+f?)\b", text, re.MULTILINE)
    }


def test_the_same_robot_gives_the_same_text(classroom, made):
    assert generate(classroom.model_copy(deep=True)) == made


def test_every_row_of_the_table_is_there_in_its_order(made):
    rows = re.findall(r"if \(\((.+)\) && (\w+)\(view(?:, (\w+))?\)\)\n\s+return STATE_(\w+);", made["transitions.h"])
    assert [
        (
            tuple(re.findall(r"state == STATE_(\w+)", states)),
            condition,
            argument.removeprefix("SIDE_").removeprefix("STATE_").lower(),
            to,
        )
        for states, condition, argument, to in rows
    ] == [
        (tuple(state.name for state in row.states), row.condition, row.argument.lower(), row.to.name)
        for row in load_transitions()
    ]


@pytest.mark.parametrize("limit", [0.34, 0.2, 0.15, 0.27, 0.42, 0.2005, 0.3333, 0.001])
def test_a_whole_millimetre_is_near_or_far_for_both_controllers_alike(limit):
    robot = robot_of(
        "nominal", f"robot.controller.wall.found_within_m={limit}", f"robot.controller.wall.lost_beyond_m={limit}"
    )
    numbers, readings = constants(generate(robot)["settings.h"]), np.arange(2500)
    np.testing.assert_array_equal(readings < numbers["WALL_FOUND_WITHIN_MM"], readings * 0.001 < limit)
    np.testing.assert_array_equal(readings > numbers["WALL_LOST_BEYOND_MM"], readings * 0.001 > limit)


@pytest.mark.parametrize("limit", [0.45, 0.2, 0.6, 0.999])
def test_a_channel_is_on_the_line_for_both_controllers_alike(limit):
    numbers = constants(generate(robot_of("nominal", f"robot.line_sensor.threshold={limit}"))["settings.h"])
    values = np.arange(256)
    np.testing.assert_array_equal(values < numbers["LINE_THRESHOLD"], values / 255 < limit)


def test_an_obstacle_is_at_the_distance_of_the_paths_for_both_controllers_alike(classroom, made):
    avoidance, numbers = classroom.controller.avoidance, constants(made["settings.h"])
    readings = np.arange(2500)
    within = np.abs(readings * 0.001 - avoidance.front_below_m) < avoidance.curves.face.tolerance_m
    low, high = numbers["FACING_NEAREST_MM"], numbers["FACING_FARTHEST_MM"]
    np.testing.assert_array_equal((low <= readings) & (high >= readings), within)


def test_every_number_of_the_controller_is_there(classroom, made):
    numbers = constants(made["settings.h"])
    assert numbers["LINE_K2_RAD_S"] == classroom.controller.line.k2_rad_s
    assert numbers["AVOIDANCE_CURVES_FACE_MAX_IN_RAD"] == classroom.controller.avoidance.curves.face.max_in_rad
    assert numbers["TRACK_M"] == classroom.drive.track_m
    assert numbers["WHEEL_RADIUS_M"] == 0.0325


def test_paths_are_the_python_controller_s_to_half_a_unit(classroom, made):
    avoidance, numbers = classroom.controller.avoidance, constants(made["paths.h"])
    per_m = numbers["PATH_UNITS_PER_M"]
    assert per_m == 2**15
    paths = {
        "STRAIGHT": straight_path(avoidance, "left"),
        "INNER": curve_path(avoidance.curves.inner, avoidance.points, "left"),
        "OUTER": curve_path(avoidance.curves.outer, avoidance.points, "left"),
    }
    for name, path in paths.items():
        table = made["paths.h"].partition(f"{name}_POINTS[")[2].partition("{")[2].partition("}")[0]
        stored = np.array(table.replace(",", " ").split(), dtype=float).reshape(-1, 2) / per_m
        assert np.abs(stored - path.points).max() <= 0.5 / per_m
        assert numbers[f"{name}_BACK_BEGINS"] == path.back_begins
        assert numbers[f"{name}_SPACING_M"] == path.spacing_m


def test_a_robot_without_curve_paths_carries_none():
    made = generate(robot_of("nominal"))
    assert "#define HAS_CURVES 0\n" in made["settings.h"]
    assert "INNER" not in made["paths.h"]


@pytest.mark.parametrize(
    ("setting", "text"),
    [
        ("avoidance.points=8001", "robot.controller.avoidance.points: got 8001, allowed: up to 8000 for the firmware"),
        ("line.k2_rad_s=5.0", "robot.controller.line: wheel set points: got 43.231, allowed: up to 32.767 rad/s"),
    ],
)
def test_what_does_not_fit_is_refused(setting, text):
    with pytest.raises(InputError) as refusal:
        generate(robot_of("nominal", f"robot.controller.{setting}"))
    assert str(refusal.value).startswith(text)

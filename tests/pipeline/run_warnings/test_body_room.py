"""Walls and obstacles that are too close for the size of the robot."""

import math
import re

import numpy as np
import pytest

from configs.draw import draw_all
from configs.loader import load_scenario
from pipeline.run_warnings.simulated_run import plan_warnings

LINE = "line: {width_m: 0.02, pieces: [{kind: straight, start: [0, 0], end: [1.9, 0]}]}"
BOX = "name: Box, center: [1.0, 0.0], size: [0.1, 0.1, 0.15], surface: wood"
PARALLEL = ("robot.controller.avoidance.front_below_m=0.6", "robot.controller.avoidance.along_length_m=1.0")
"""The body, 0.18 m long, is beside the box only where the path is parallel to the line."""


def warnings_of(width_m, *, arena="", box=BOX, start_deg=0.0, settings=()):
    start_m = 0.1 if start_deg == 0.0 else 1.8
    spec = draw_all(
        load_scenario(
            "smoke",
            [
                f"routes=[{{name: E, start: {{x_m: {start_m}, y_m: 0, yaw_deg: {start_deg}}}}}]",
                f"arena={{name: a, floor: {{half_extent_m: 2}}, {LINE}, obstacles: [{{{box}}}]{arena}}}",
                f"robot.chassis.width_m={width_m}",
                *PARALLEL,
                "stop={lap: false, time_limit_s: 2}",
                *settings,
            ],
        )
    )
    return plan_warnings(spec)


@pytest.mark.parametrize("start_deg", [0.0, 180.0])
@pytest.mark.parametrize(("width_m", "room_mm"), [(0.239, 20), (0.259, 10)])
def test_too_little_room_between_path_and_obstacle_is_named(width_m, room_mm, start_deg):
    """The path is 0.19 m beside the line: 0.19 m - 0.05 m - width / 2 remain. A tenth of the width is needed."""
    (warning,) = warnings_of(width_m, start_deg=start_deg)
    assert "the path past obstacle Box, 0.19 m beside the line, leaves" in warning
    assert f"leaves {room_mm} mm between it and the body of the robot (0.18 m x {width_m:g} m), which" in warning
    assert f"needs about {100 * width_m:.0f} mm" in warning


def test_a_path_without_room_for_the_body_is_named():
    (warning,) = warnings_of(0.30)
    assert "leaves no room for the body of the robot (0.18 m x 0.3 m): " in warning


@pytest.mark.parametrize(
    ("width_m", "given"),
    [
        (0.22, {}),  # 0.19 m - 0.05 m - 0.11 m = 30 mm, more than 22 mm
        (0.26, {"settings": ["robot.controller.avoidance.side_m=0.22"]}),
        (0.30, {"box": f"{BOX}, solid: false"}),
        (0.30, {"box": f"{BOX}, motion: {{waypoints: [{{t_s: 1, offset: [0, 0.2]}}]}}"}),
    ],
)
def test_enough_room_and_obstacles_that_move_or_are_not_solid_get_no_warning(width_m, given):
    assert warnings_of(width_m, **given) == ()


@pytest.mark.parametrize(
    ("y_m", "texts"), [(0.15, ["touches"]), (0.1701, ["leaves 10 mm between itself and"]), (0.183, [])]
)
def test_a_body_that_touches_what_is_beside_the_line_or_has_little_room_is_named(y_m, texts):
    """Half of the width is 0.11 m, half of the box is 0.05 m; a tenth of the width is needed."""
    warnings = warnings_of(0.22, box=BOX.replace("0.0]", f"{y_m}]"))
    assert len(warnings) == len(texts)
    assert all(f"{text} obstacle Box if it follows the line" in warnings[0] for text in texts)


def test_a_wall_that_the_body_touches_is_named():
    """Its face is 0.1 m to the left of the line, and half of the width is 0.11 m."""
    wall = ", walls: [{name: W, start: [1.8, 0.1], end: [0.3, 0.1], surface: wood}]"
    (warning,) = warnings_of(0.22, arena=wall)
    assert "touches wall W if it follows the line" in warning


BEND_M = 0.3
"""Radius of a bend to the left about (0.5, 0.3), after a straight along x."""


def warnings_in_a_bend(distance_m, *, inside=False, settings=()):
    """Return the warnings about a wall across the line from the centre of the bend to its middle."""
    out = np.array([1.0, -1.0]) / math.sqrt(2)
    along = np.array([1.0, 1.0]) / math.sqrt(2)
    middle = (0.5, 0.3) + distance_m * out
    ends = [middle - 0.02 * along, middle + 0.02 * along]
    start, end = [end.tolist() for end in (ends[::-1] if inside else ends)]
    straight = "{kind: straight, start: [0, 0], end: [0.5, 0]}"
    bend = f"{{kind: arc, center: [0.5, 0.3], radius_m: {BEND_M}, start_deg: -90, end_deg: 0}}"
    line = f"line: {{width_m: 0.02, pieces: [{straight}, {bend}]}}"
    wall = f"walls: [{{name: W, start: {start}, end: {end}, surface: wood}}]"
    arena = f"arena={{name: a, floor: {{half_extent_m: 2}}, {line}, {wall}, obstacles: []}}"
    routes = "routes=[{name: E, start: {x_m: 0.1, y_m: 0, yaw_deg: 0}}]"
    body = ("robot.chassis.length_m=0.2", "robot.chassis.width_m=0.16")
    overrides = [routes, arena, *body, "stop={lap: false, time_limit_s: 2}", *settings]
    return plan_warnings(draw_all(load_scenario("smoke", overrides)))


REACH_M = math.hypot(BEND_M + 0.08, 0.1)
"""Distance of the outer corners of the body from the centre of the bend: sqrt((r + w)^2 + l^2)."""


@pytest.mark.parametrize(
    ("room_m", "text"),
    [
        (-0.001, "touches wall W"),
        (0.0031, "leaves 3 mm between itself and"),
        (0.0152, "leaves 15 mm"),
        (0.017, ""),
    ],
)
def test_the_corners_of_the_body_swing_out_in_a_bend(room_m, text):
    """A tenth of the width, 16 mm, is needed. Without the corners, the body would reach 0.38 m, which is 13 mm less."""
    assert math.isclose(REACH_M, 0.38 + 0.0129, abs_tol=1e-4)
    warnings = warnings_in_a_bend(REACH_M + room_m)
    assert len(warnings) == bool(text)
    if text:
        assert text in warnings[0]
        place = re.search(r"at x = ([0-9.]+), y = ([0-9.-]+) m", warnings[0])
        assert place is not None
        x, y = map(float, place.groups())
        assert math.hypot(x - 0.5, y - 0.3) == pytest.approx(BEND_M, abs=0.01)  # on the bend, in steps of 1 cm
        assert math.degrees(math.atan2(y - 0.3, x - 0.5)) == pytest.approx(-45.0, abs=25.0)


@pytest.mark.parametrize(("room_m", "is_named"), [(-0.001, True), (0.0152, True), (0.017, False)])
def test_the_inner_side_of_the_body_is_beside_the_bend(room_m, is_named):
    """A wall of 4 cm inside the bend, whose ends are farther away than its middle: r - w from the centre."""
    assert len(warnings_in_a_bend(BEND_M - 0.08 - room_m, inside=True)) == is_named

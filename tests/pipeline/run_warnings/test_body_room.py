"""Walls and obstacles that are too close for the size of the robot."""

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


@pytest.mark.parametrize(("y_m", "is_touched"), [(0.15, True), (0.17, False)])
def test_a_body_that_touches_what_is_beside_the_line_is_named(y_m, is_touched):
    """Half of the width is 0.11 m, half of the box is 0.05 m."""
    warnings = warnings_of(0.22, box=BOX.replace("0.0]", f"{y_m}]"))
    assert [("touches obstacle Box if it follows the line" in text) for text in warnings] == [True] * is_touched


def test_a_wall_that_the_body_touches_is_named():
    """Its face is 0.1 m to the left of the line, and half of the width is 0.11 m."""
    wall = ", walls: [{name: W, start: [1.8, 0.1], end: [0.3, 0.1], surface: wood}]"
    (warning,) = warnings_of(0.22, arena=wall)
    assert "touches wall W if it follows the line" in warning

"""A fisheye lens that sees the floor beneath the robot shows a shadow, and the robot only with `sees_robot`."""

import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.run_warnings.simulated_run import plan_warnings

REAR = "robot.sensors.rear={{kind: camera, x_m: -0.1, z_m: 0.12, fisheye: {{field_of_view_deg: 160}}{more}}}"


def warnings_of(*settings):
    return plan_warnings([draw_run(load_scenario("smoke", settings), "CW", 1)])


@pytest.mark.parametrize(
    ("setting", "place"),
    [
        ("robot.camera.fisheye.field_of_view_deg=160", "robot.camera"),
        (REAR.format(more=", pitch_up_deg: -30"), "robot.sensors.rear"),
    ],
)
def test_a_lens_that_sees_beneath_the_robot_gets_a_warning_with_the_cure(setting, place):
    """At 4 : 3 it sees 60 degrees below its axis, which is 30 degrees below the horizon."""
    (text,) = warnings_of(setting)
    assert f"{place} sees the shadow of the robot on the floor, but not the robot" in text
    assert f"with {place}.sees_robot=true" in text


@pytest.mark.parametrize(
    "settings",
    [
        ("robot.camera.fisheye.field_of_view_deg=160", "robot.camera.sees_robot=true"),
        ("robot.camera.fisheye.field_of_view_deg=160", "robot.camera.pitch_down_deg=0"),
        (REAR.format(more=", pitch_up_deg: -30, sees_robot: true"),),
        ("robot.camera.pitch_down_deg=60",),
    ],
)
def test_other_cameras_get_none(settings):
    assert warnings_of(*settings) == ()

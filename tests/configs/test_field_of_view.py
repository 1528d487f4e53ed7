"""The field of view in place of the focal length f, against the pinhole: sensor width / (2 f) = tan(angle / 2)."""

import math

import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from configs.schema.scenario import RunSpec
from symolo.core.errors import InputError

SENSOR_MM = 42.33


def spec_of(*settings):
    return draw_run(load_scenario("smoke", settings), "CW", 1)


def angle_deg(camera):
    return math.degrees(2 * math.atan(camera.sensor_width_mm / (2 * camera.focal_length_mm)))


@pytest.mark.parametrize(
    "settings",
    [
        ("robot.camera.field_of_view_deg=90",),
        ("robot.camera={field_of_view_deg: 90}",),
        ("robot.camera.focal_length_mm=20", "robot.camera.field_of_view_deg=90"),
        ("robot.camera.field_of_view_deg=90", "robot.camera.sensor_width_mm=4.8"),
    ],
)
def test_an_angle_replaces_the_focal_length(settings):
    spec = spec_of(*settings)
    assert spec.robot.camera.focal_length_mm == pytest.approx(
        spec.robot.camera.sensor_width_mm / 2
    )  # tan 45 degrees is 1
    assert RunSpec.model_validate_json(spec.model_dump_json()) == spec


def test_a_focal_length_replaces_the_angle_of_the_robot_that_is_extended(tmp_path):
    (tmp_path / "wide.yaml").write_text("extends: nominal\nname: wide\ncamera: {field_of_view_deg: 100}\n")
    (tmp_path / "long.yaml").write_text("extends: wide.yaml\nname: long\ncamera: {focal_length_mm: 60}\n")
    wide, long = (spec_of(f"robot={tmp_path / name}").robot.camera for name in ("wide.yaml", "long.yaml"))
    assert angle_deg(wide) == pytest.approx(100)
    assert long.focal_length_mm == 60


def test_an_angle_may_be_drawn_and_is_recorded():
    spec = spec_of("robot.camera.field_of_view_deg={uniform: [60, 90]}")
    drawn = spec.drawn["robot.camera.field_of_view_deg"]
    assert 60 <= drawn <= 90
    assert angle_deg(spec.robot.camera) == pytest.approx(drawn)


def test_a_further_camera_has_an_angle_too():
    spec = spec_of("robot.sensors.rear={kind: camera, field_of_view_deg: 120}")
    assert angle_deg(spec.robot.sensors.get("rear")) == pytest.approx(120)


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("robot.camera={field_of_view_deg: 60, focal_length_mm: 30}", "either field_of_view_deg or focal_length_mm"),
        ("robot.camera.field_of_view_deg=179.9", r"4\.85 to 174\.6 degrees with sensor_width_mm 42\.33"),
        ("robot.camera.field_of_view_deg=0", "number > 0 and < 180"),
        ("robot.camera.field_of_view_deg=wide", "number > 0 and < 180"),
        ("robot.sensors.rear={kind: camera, field_of_view_deg: 90, fisheye: {}}", r"fisheye\.field_of_view_deg"),
    ],
)
def test_an_angle_that_cannot_be_is_refused(setting, message):
    with pytest.raises(InputError, match=message):
        spec_of(setting)

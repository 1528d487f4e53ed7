"""Warnings of runs that are probably not what their scenario was meant to make."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from configs.draw import draw_all
from configs.loader import load_scenario
from configs.references import shipped_names
from pipeline.planning.plan import ScenarioPlan
from pipeline.run_warnings.angles import settings_in_radians
from pipeline.run_warnings.simulated_run import plan_warnings, run_warnings, start_to_line
from pipeline.stages.simulate import simulate
from tests.release_fixtures import ONE_ROUTE


def spec_of(x_m=0.55, yaw_deg=-90.0):
    start = f"{{x_m: {x_m}, y_m: -0.2, yaw_deg: {yaw_deg}}}"
    (spec,) = draw_all(
        load_scenario("smoke", [f"routes=[{{name: CW, start: {start}, runs: 1}}]", "stop.time_limit_s=2"])
    )
    return spec


def warnings_of(**start):
    spec = spec_of(**start)
    return run_warnings(spec, simulate(spec).recording)


@pytest.mark.parametrize("yaw_deg", [-90.0, 90.0, -85.0])
def test_a_run_along_the_line_gets_no_warning(yaw_deg):
    assert warnings_of(yaw_deg=yaw_deg) == ()


@pytest.mark.parametrize(("yaw", "degrees"), [(-1.57, -90), (1.5708, 90), (4.712389, 270)])
def test_a_start_in_radians_is_named_with_the_number_in_degrees(yaw, degrees):
    """The line of the arena `symolo` leads along y at the start of the shipped routes."""
    lost, unit = warnings_of(yaw_deg=yaw)
    assert "the line sensor did not see the line in 100 % of the time" in lost
    assert f"yaw_deg {yaw:g} looks like radians" in unit
    assert f"write yaw_deg: {degrees}" in unit


@pytest.mark.parametrize(("yaw", "degrees"), [(3.14, 180), (3.1416, 180), (6.2832, 360)])
def test_a_start_along_the_line_in_either_unit_is_named_if_it_is_half_a_turn_in_radians(yaw, degrees):
    """The line leads along x at the start, so that both 3.14 degrees and half a turn are along it."""
    course = "arena.line.course={points: [[-0.7, -0.6], [0.7, -0.6], [0.7, 0.6], [-0.7, 0.6]], bend_radius_m: 0.3}"
    route = f"routes=[{{name: CW, start: {{x_m: 0.0, y_m: -0.6, yaw_deg: {yaw}}}, runs: 1}}]"
    bare = ("arena.walls=[]", "arena.obstacles=[]")
    (warning,) = plan_warnings(draw_all(load_scenario("symolo", [*bare, course, route])))
    assert f"yaw_deg {yaw:g} looks like radians; if it is in radians, write yaw_deg: {degrees}" in warning
    for degrees_away in (3.0, 177.0, 3.5):
        other = route.replace(f"yaw_deg: {yaw}", f"yaw_deg: {degrees_away}")
        assert plan_warnings(draw_all(load_scenario("symolo", [*bare, course, other]))) == ()


@pytest.mark.parametrize(
    ("setting", "field", "angle", "degrees"),
    [
        ("robot.sensors.r2={kind: vl53l0x, yaw_deg: 1.57}", "robot.sensors.r2.yaw_deg", "1.57", 90),
        ("robot.tof.mounts.left.yaw_deg=0.785", "robot.tof.mounts.left.yaw_deg", "0.785", 45),
        ("robot.camera.yaw_left_deg=-1.5708", "robot.camera.yaw_left_deg", "-1.5708", -90),
        ("robot.sensors.r2={kind: lidar, roll_deg: 3.14159}", "robot.sensors.r2.roll_deg", "3.14159", 180),
        ("robot.tof.mounts.left.yaw_deg=0.524", "robot.tof.mounts.left.yaw_deg", "0.524", 30),
        ("robot.tof.mounts.left.yaw_deg=1.4", "robot.tof.mounts.left.yaw_deg", "1.4", 80),
        ("robot.tof.mounts.right.yaw_deg=-1.3963", "robot.tof.mounts.right.yaw_deg", "-1.3963", -80),
        ("robot.camera.pitch_down_deg=1.0472", "robot.camera.pitch_down_deg", "1.0472", 60),
        ("robot.camera.pitch_down_deg=1.047", "robot.camera.pitch_down_deg", "1.047", 60),
        ("arena.obstacles.0.yaw_deg=0.785", "arena.obstacles.0.yaw_deg", "0.785", 45),
        ("robot.tof.field_of_view_deg=0.436", "robot.tof.field_of_view_deg", "0.436", 25),
        ("look.sun.elevation_deg=1.05", "look.sun.elevation_deg", "1.05", 60),
        ("look.sun.azimuth_from_window_deg=-0.785", "look.sun.azimuth_from_window_deg", "-0.785", -45),
        ("look.floor.yaw_deg=1.57", "look.floor.yaw_deg", "1.57", 90),
        ("look.desk_lamps.tilt_deg=0.524", "look.desk_lamps.tilt_deg", "0.524", 30),
    ],
)
def test_a_setting_in_radians_is_named_with_the_number_in_degrees(setting, field, angle, degrees):
    (spec,) = draw_all(load_scenario("smoke", [ONE_ROUTE, setting]))
    (warning,) = plan_warnings([spec])
    assert f"{field} {angle} looks like radians" in warning
    assert warning.endswith(f"write {field.rpartition('.')[2]}: {degrees}")


@pytest.mark.parametrize(
    "yaw", ["0", "1.5", "1.2", "-0.8", "2", "0.52", "1.05", "1.049", "0.001", "{uniform: [1.5707, 1.5709]}"]
)
def test_small_angles_of_a_mount_and_drawn_ones_get_no_warning(yaw):
    assert plan_warnings(draw_all(load_scenario("smoke", [ONE_ROUTE, f"robot.camera.yaw_left_deg={yaw}"]))) == ()


@pytest.mark.parametrize(
    "setting",
    [
        "arena.obstacles.0.yaw_deg=1",
        "look.sun.elevation_deg=2",
        "robot.tof.field_of_view_deg=2",
        "look.sun.elevation_deg={uniform: [1, 1.5]}",
        "look.sun.angular_diameter_deg=1.57",
        "look.floor.yaw_deg={choice: [0.785]}",
    ],
)
def test_other_small_angles_and_drawn_ones_get_no_warning(setting):
    assert plan_warnings(draw_all(load_scenario("smoke", [ONE_ROUTE, setting]))) == ()


@pytest.mark.parametrize("name", shipped_names("look"))
def test_shipped_looks_have_no_angle_in_radians(name):
    for spec in draw_all(load_scenario("smoke", [f"look={name}"])):
        assert list(settings_in_radians(spec)) == []


def test_a_warning_of_the_plan_is_printed_once(symolo, tiny, tmp_path):
    setting = "robot.camera.yaw_left_deg=0.785"
    ended = symolo("simulate", "smoke", "--out", tmp_path / "out", *tiny, "--set", setting, "--workers", "1")
    assert ended.code == 0
    assert (ended.out + ended.err).count("looks like radians") == 1


def test_a_preview_prints_angles_in_radians(symolo, tmp_path):
    settings = ("--set", "look.sun.azimuth_from_window_deg=0.785", "--width-px", 64)
    ended = symolo("preview", "smoke", "-n", 2, "--engine", "flat", *settings, "--out", tmp_path / "sheet.png")
    assert ended.code == 0
    assert ended.err.count("warning: look.sun.azimuth_from_window_deg 0.785 looks like radians") == 1


@pytest.mark.parametrize(
    ("setting", "beginning"),
    [
        # No load: (6 V K / R - Tq) / (K^2 / R + B) = (1.6821 - 0.0174) / (0.2243 + 0.0027) = 7.33 rad/s, x 32.5 mm;
        # the outer wheel at the largest error: 0.18 - 3.5 * 0.02 + 3.5 * 0.9 * 0.07 = 0.33 m/s.
        (
            "robot.motor.torque_constant_N_m_A=0.8",
            "robot.controller.line asks a wheel for 0.33 m/s at an error of 3.5, and the motors reach 0.24 m/s at 6 V ",
        ),
        (
            "robot.tof.mounts.left.y_m=0.4",
            "robot.tof.mounts.left.y_m 0.4 is far outside the body, whose width is 0.17 m",
        ),
        ("robot.line_sensor.x_m=0.3", "robot.line_sensor.x_m 0.3 is far outside the body, whose length is 0.18 m"),
    ],
)
def test_a_plan_names_what_a_robot_cannot_do_or_be_meant_to_have(setting, beginning):
    (warning,) = plan_warnings(draw_all(load_scenario("smoke", [ONE_ROUTE, setting])))
    assert warning.startswith(f"CW/test_1: {beginning}")


@pytest.mark.parametrize(("limit_s", "is_named"), [(2, True), (20, True), (21, False)])
def test_a_plan_names_a_time_limit_within_which_no_lap_can_be_finished(limit_s, is_named):
    """The line of the arena `symolo` is 3.68 m long; at no error, the controller drives 0.18 m/s: 20.5 s."""
    route = "routes=[{name: CW, start: {x_m: 0.55, y_m: -0.2, yaw_deg: -90}, runs: 2}]"
    for lap in ("true", "false"):
        settings = [route, f"stop.lap={lap}", f"stop.time_limit_s={limit_s}"]
        warnings = plan_warnings(draw_all(load_scenario("smoke", settings)))
        text = (
            "CW/test_1 and 1 more run: no lap can be finished within stop.time_limit_s, which is"
            f" {limit_s}, and stop.lap makes the run fail then: the 3.68 m of the line take 20.5 s at 0.18 m/s, the"
            " largest speed of the controller; raise the limit, or set stop.lap=false"
        )
        assert warnings == ((text,) if is_named and lap == "true" else ())


def test_a_start_beside_the_line_is_named_with_its_distance():
    """The line is at x = 0.55 m."""
    (warning,) = warnings_of(x_m=0.2)
    assert "the run starts 0.35 m away from the line" in warning


def test_a_plan_names_a_start_far_from_the_line():
    """The line is at x = 0.55 m."""
    (warning,) = plan_warnings([spec_of(x_m=0.2)])
    assert warning.startswith("CW/test_1: the run starts 0.35 m away from the line")


@pytest.mark.parametrize(
    ("start", "text"),
    [
        ({}, "0.000 m, 0 deg"),
        ({"yaw_deg": 90.0}, "0.000 m, 0 deg"),
        ({"yaw_deg": -77.0}, "0.000 m, 13 deg"),
        ({"x_m": 0.2, "yaw_deg": 85.5}, "0.350 m, -4.5 deg"),
    ],
)
def test_a_plan_has_the_place_of_a_start_on_the_line(start, text):
    """The line leads along y at x = 0.55 m."""
    spec = spec_of(**start)
    assert start_to_line(spec) == text
    row = next(line for line in ScenarioPlan.from_specs([spec], 1).text().splitlines() if line.startswith("CW/test_1"))
    assert row.endswith(f"160 x 120    {text}")


def test_a_warning_of_several_runs_is_stated_once_with_their_number_and_the_first():
    beside, further = (spec_of(x_m=x_m).model_copy(update={"run": 2}) for x_m in (0.2, 0.0))
    same = beside.model_copy(update={"run": 3})
    (warning,) = plan_warnings([spec_of(), beside, same])
    assert warning.startswith("CW/test_2 and 1 more run: the run starts 0.35 m away from the line")
    (warning,) = plan_warnings([beside, same, further.model_copy(update={"run": 4})])
    assert warning.startswith("CW/test_2 and, with other numbers, 2 more runs: the run starts 0.35 m away")


def test_a_plan_names_a_wall_across_the_line():
    """Wall B of the arena that is extended leads from (-0.52, -0.72) to (-0.49, 0.30), over the lower left corner."""
    course = "arena.line.course={points: [[-0.7, -0.6], [0.7, -0.6], [0.7, 0.6], [-0.7, 0.6]], bend_radius_m: 0.3}"
    route = "routes=[{name: CW, start: {x_m: 0.0, y_m: -0.6, yaw_deg: 0}, runs: 1}]"
    (spec,) = draw_all(load_scenario("symolo", [course, route]))
    warning, beside = plan_warnings([spec])
    assert "between itself and wall A2" in beside
    named = re.match(r"CW/test_1: the line leads through wall B at x = (-0\.\d\d), y = (-0\.\d\d) m", warning)
    assert named is not None
    x, y = map(float, named.groups())
    assert x == pytest.approx(-0.51, abs=0.02)
    assert np.hypot(x + 0.4, y + 0.3) == pytest.approx(0.3, abs=0.01), "on the bend of 0.3 m around (-0.4, -0.3)"
    (free,) = draw_all(load_scenario("symolo", [course, route, "arena.walls=[]"]))
    assert plan_warnings([free]) == ()


@pytest.mark.parametrize("name", shipped_names("scenario"))
def test_plans_of_the_shipped_scenarios_have_no_warning(name):
    assert plan_warnings(draw_all(load_scenario(name))) == ()


def test_a_robot_that_stands_still_is_named():
    spec = spec_of()
    recording = simulate(spec).recording
    pose = np.repeat(recording.trajectory.pose[:1], len(recording.trajectory.pose), axis=0)
    still = replace(recording, trajectory=replace(recording.trajectory, pose=pose))
    (warning,) = run_warnings(spec, still)
    assert warning.startswith("the robot moves less than 1 cm")


def test_a_plan_has_the_warning_before_anything_is_simulated(symolo):
    setting = "routes=[{name: CW, start: {x_m: 0.55, y_m: -0.2, yaw_deg: -1.57}, runs: 1}]"
    warning = "CW/test_1: yaw_deg -1.57 looks like radians"
    assert f"WARNING    {warning}" in symolo("plan", "smoke", "--set", setting).out
    (text,) = json.loads(symolo("plan", "smoke", "--set", setting, "--json").out)["warnings"]
    assert text.startswith(warning)
    assert "WARNING" not in symolo("plan", "smoke").out


def test_terminal_metadata_and_report_have_the_warning(tmp_path, symolo, hands, tiny):
    del hands  # the images are painted
    setting = "routes=[{name: CW, start: {x_m: 0.55, y_m: -0.2, yaw_deg: -1.57}, runs: 1}]"
    out = tmp_path / "data"
    ended = symolo("release", "smoke", "--out", out, "--set", setting, *tiny)
    assert ended.code == 0
    before, _, after = (ended.err + ended.out).partition("simulate: ")
    assert "warning: CW/test_1: yaw_deg -1.57 looks like radians" in before
    assert "looks like radians" not in after
    (run,) = json.loads((out / "metadata.json").read_text())["runs"]
    assert any("looks like radians" in text for text in run["warnings"])
    assert "looks like radians" in (out / "README.md").read_text()


ROOM = "name: room\npolygons:\n  - {name: wall, points: [[-2, -1.5], [2, -1.5], [2, 1.5], [-2, 1.5]]}\n"


def test_an_arena_may_have_no_line_which_the_built_in_controller_needs(tmp_path):
    (tmp_path / "room.yaml").write_text(ROOM)
    (tmp_path / "scenario.yaml").write_text("extends: smoke\narena: room.yaml\n")
    specs = draw_all(load_scenario(str(tmp_path / "scenario.yaml")))
    assert all(spec.arena.line.pieces == () for spec in specs)
    (warning,) = plan_warnings(specs)
    assert "the arena has no line that the built-in controller could follow" in warning

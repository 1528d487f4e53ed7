"""Limits between several fields: what lies at the limit is accepted or refused, and what lies just beyond is not."""

import numpy as np
import pytest

from configs.checks.arena import _outermost, arena_faults
from configs.checks.look import look_faults
from configs.checks.robot import robot_faults
from configs.checks.scenario import _period_faults, _start_faults, check_robot
from configs.draw import draw_look, draw_robot
from configs.loader import load_scenario, load_section
from configs.robot_sensors import RobotSensors
from configs.schema.appearance.look import LookConfig
from configs.schema.arena import ArcPiece, ArenaConfig
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Rates, Route
from sensors.bumper import BumperSettings
from sensors.camera.further_camera import CameraSettings
from sensors.effects.line_sensor.line_adc_saturation import LineAdcSaturation
from sensors.effects.pose_log.pose_clock_drift import PoseClockDrift
from sensors.ranging.ultrasonic import UltrasonicSettings
from symolo.core.errors import InputError
from symolo.core.yaml.tree import dotted

LITTLE = 1e-6


@pytest.fixture(scope="module")
def robot() -> RobotConfig:
    return draw_robot(load_section("robot", "nominal"), 1)[0]


@pytest.fixture(scope="module")
def look() -> LookConfig:
    return draw_look(load_section("look", "classroom"), 1)[0]


def changed(section, changes):
    """The section with new values of its fields, given by their paths."""
    for path, value in changes.items():
        name, _, rest = path.partition(".")
        section = section.model_copy(update={name: changed(getattr(section, name), {rest: value}) if rest else value})
    return section


def paths(faults) -> list[str]:
    return [dotted(fault.path) for fault in faults]


@pytest.mark.parametrize(
    ("accepted", "refused", "path"),
    [
        ({"tof.min_range_m": 1.2 - LITTLE}, {"tof.min_range_m": 1.2}, "tof.min_range_m"),
        ({"chassis.clearance_m": 0.05 - LITTLE}, {"chassis.clearance_m": 0.05}, "chassis.clearance_m"),
        (
            {"camera.height_above_base_m": -0.05 + LITTLE},
            {"camera.height_above_base_m": -0.05},
            "camera.height_above_base_m",
        ),
        ({"tof.no_target_m": 0.04}, {"tof.no_target_m": 0.04 + LITTLE}, "tof.no_target_m"),
        ({"tof.no_target_m": 1.2}, {"tof.no_target_m": 1.2 - LITTLE}, "tof.no_target_m"),
        ({"tof.no_target_m": 0.0}, {"tof.no_target_m": 0.1}, "tof.no_target_m"),
        ({"drive.track_m": 0.17 - 0.02}, {"drive.track_m": 0.15 + LITTLE}, "drive.track_m"),
        (
            {"drive.wheel_diameter_m": 0.012 + LITTLE},
            {"drive.wheel_diameter_m": 0.012},
            "drive.wheel_diameter_m",
        ),
        ({"drive.wheel_diameter_m": 0.18}, {"drive.wheel_diameter_m": 0.18 + LITTLE}, "drive.wheel_diameter_m"),
        ({"drive.caster_x_m": -0.09}, {"drive.caster_x_m": -0.09 - LITTLE}, "drive.caster_x_m"),
        (
            {"drive.caster_x_m": 0.09, "chassis.center_of_mass_x_m": 0.03},
            {"drive.caster_x_m": 0.09 + LITTLE, "chassis.center_of_mass_x_m": 0.03},
            "drive.caster_x_m",
        ),
        ({"chassis.center_of_mass_x_m": 0.0}, {"chassis.center_of_mass_x_m": LITTLE}, "chassis.center_of_mass_x_m"),
        (
            {"chassis.center_of_mass_x_m": -0.07},
            {"chassis.center_of_mass_x_m": -0.07 - LITTLE},
            "chassis.center_of_mass_x_m",
        ),
        (
            {"drive.caster_x_m": -LITTLE, "chassis.center_of_mass_x_m": 0.0},
            {"drive.caster_x_m": 0.0, "chassis.center_of_mass_x_m": 0.0},
            "chassis.center_of_mass_x_m",
        ),
    ],
)
def test_a_robot_at_the_limit(robot, accepted, refused, path):
    assert paths(robot_faults(changed(robot, accepted), in_simulation=True)) == []
    assert f"robot.{path}" in paths(robot_faults(changed(robot, refused), in_simulation=True))


@pytest.mark.parametrize(("no_target_m", "limit"), [(0.21, "min_range_m"), (0.23, "max_range_m")])
def test_a_value_without_target_contradicts_the_limit_that_is_nearer_as_a_ratio(robot, no_target_m, limit):
    """Valid ranges are 0.04 m to 1.2 m, whose geometric mean is 0.219 m."""
    (fault,) = robot_faults(changed(robot, {"tof.no_target_m": no_target_m}), in_simulation=True)
    assert dotted(fault.against) == f"robot.tof.{limit}"


def test_a_fault_of_a_further_sensor_has_its_place_in_the_robot(robot):
    rear = UltrasonicSettings(min_range_m=1.0, max_range_m=0.5)
    made = robot.model_copy(update={"sensors": RobotSensors((("rear", rear),))})
    (fault,) = robot_faults(made, in_simulation=True)
    assert dotted(fault.path) == "robot.sensors.rear.min_range_m"
    assert dotted(fault.against) == "robot.sensors.rear.max_range_m"


@pytest.mark.parametrize(("battery_V", "limit_V"), [(6.0, 9.0), (9.0, 6.0)])
def test_a_motor_must_overcome_its_friction_at_the_lower_of_both_voltages(robot, battery_V, limit_V):
    """0.5 N m/A * 6 V / 3 ohm are 1 N m."""
    power = {"power.battery_voltage_V": battery_V, "power.motor_voltage_limit_V": limit_V}
    motor = {"motor.torque_constant_N_m_A": 0.5, "motor.winding_resistance_ohm": 3.0}
    strong = changed(robot, power | motor | {"motor.coulomb_friction_N_m": 1.0 - LITTLE})
    weak = changed(robot, power | motor | {"motor.coulomb_friction_N_m": 1.0})
    assert paths(robot_faults(strong, in_simulation=True)) == []
    (fault,) = robot_faults(weak, in_simulation=True)
    assert fault.allowed == "less than 1, its torque at 6.0 V and 3.0 ohm with 0.5 N m/A"


def test_an_effect_that_a_bench_measures_but_the_simulation_cannot_is_refused_for_the_simulation(robot):
    """Poses of the future."""
    early = robot.with_effect(PoseClockDrift(rate=-0.001))
    assert paths(robot_faults(early, in_simulation=True)) == ["robot.effects.pose_clock_drift.rate"]
    assert paths(robot_faults(early, in_simulation=False)) == []
    check_robot(early, load_section("robot", "nominal").tree)
    with pytest.raises(InputError, match=r"robot\.effects\.pose_clock_drift\.rate"):
        load_scenario("symolo", ["robot.effects.pose_clock_drift.rate=-0.001"])


def test_either_a_board_or_a_controller_drives():
    board, controller = "board.kind=simulated", "controller.program={}"
    for alone in (board, controller):
        load_scenario("symolo", [alone])
    with pytest.raises(InputError, match="controller; allowed: none, since the board drives"):
        load_scenario("symolo", [board, controller])


def test_a_fault_of_an_effect_names_the_other_field_if_there_is_one(robot):
    saturated, early = LineAdcSaturation(low=0.5, high=0.3), PoseClockDrift(rate=-0.001)
    both = robot.with_effect(saturated).with_effect(early)
    other = {dotted(fault.path): dotted(fault.against) for fault in robot_faults(both, in_simulation=True)}
    assert other == {
        "robot.effects.line_adc_saturation.low": "robot.effects.line_adc_saturation.high",
        "robot.effects.pose_clock_drift.rate": "",
    }


@pytest.mark.parametrize(
    ("field", "steps", "write"),
    [
        ("period_s", 33.0, ""),
        ("period_s", 1.0, ""),
        ("period_s", 33.4, "0.033"),
        ("period_s", 33.6, "0.034"),
        ("period_s", 0.4, "0.001"),
        ("period_s", 0.0, "0.001"),
        ("delay_s", 0.0, ""),
        ("delay_s", 0.4, "0"),
        ("delay_s", 1.0, ""),
    ],
)
@pytest.mark.parametrize("sensor", ["tof", "line_sensor", "encoder"])
def test_times_of_sensors_are_whole_steps_and_a_period_is_at_least_one(robot, sensor, field, steps, write):
    made = changed(robot, {f"{sensor}.{field}": steps / 1000})
    faults = list(_period_faults(Rates(physics_hz=1000), made))
    assert [(dotted(fault.path), fault.cure) for fault in faults] == (
        [(f"robot.{sensor}.{field}", f"write {write}")] if write else []
    )


def test_a_bumper_is_sampled_in_whole_steps_and_a_camera_between_them_too(robot):
    sensors = (
        ("bumper", BumperSettings(kind="bumper", period_s=0.0334)),
        ("rear", CameraSettings(kind="camera", period_s=0.0334)),
    )
    made = robot.model_copy(update={"sensors": RobotSensors(sensors)})
    assert paths(_period_faults(Rates(physics_hz=1000), made)) == ["robot.sensors.bumper.period_s"]


def arena(pieces=(), walls=(), obstacles=(), **fields) -> ArenaConfig:
    return ArenaConfig.model_validate(
        {"name": "made", "line": {"width_m": 0.1, "pieces": pieces}, "walls": walls, "obstacles": obstacles} | fields
    )


def straight(start, end):
    return {"kind": "straight", "start": start, "end": end}


def arc(start_deg, end_deg, radius_m=1.0, center=(0.0, 0.0)):
    return {"kind": "arc", "center": center, "radius_m": radius_m, "start_deg": start_deg, "end_deg": end_deg}


@pytest.mark.parametrize(
    ("piece", "problems"),
    [
        (straight((0, 0), (0.001, 0)), []),
        (straight((0, 0), (0.0009, 0)), ["a straight piece of no length"]),
        (arc(0.0, 0.1), []),
        (arc(0.09, 0.0), ["an arc of no length"]),
        (arc(360, 0), []),
        (arc(0, 360.01), ["the arc overlaps itself"]),
        (arc(0, 90, radius_m=0.05 + LITTLE), []),
        (arc(0, 90, radius_m=0.05), [""]),
    ],
)
def test_a_piece_of_line_at_its_limits(piece, problems):
    assert [fault.problem for fault in arena_faults(arena([piece]))] == problems


@pytest.mark.parametrize(("x_m", "asks"), [(12.0, True), (12.0 - LITTLE, False)])
def test_beyond_three_times_the_floor_lengths_may_not_be_in_metres(x_m, asks):
    """The floor ends at 4 m."""
    (fault,) = arena_faults(arena(obstacles=[{"name": "O", "center": (x_m, 0.0), "size": (0.2, 0.2, 0.1)}]))
    assert fault.cure.startswith("are the lengths of the arena in metres?") is asks


@pytest.mark.parametrize(("diameter_m", "against"), [(0.012, "clearance_m"), (0.19, "length_m")])
def test_a_wheel_is_too_small_for_the_clearance_or_too_large_for_the_length(robot, diameter_m, against):
    (fault,) = robot_faults(changed(robot, {"drive.wheel_diameter_m": diameter_m}), in_simulation=True)
    assert dotted(fault.against) == f"robot.chassis.{against}"


def test_a_wall_of_a_millimetre_is_one():
    walls = [{"name": "A", "start": (0, 0), "end": (0, 0.001)}, {"name": "B", "start": (1, 0), "end": (1, 0.0009)}]
    assert paths(arena_faults(arena(walls=walls))) == ["arena.walls.1"]


@pytest.mark.parametrize(
    "turned", [lambda x, y: (x, y), lambda x, y: (-x, y), lambda x, y: (y, x), lambda x, y: (y, -x)]
)
def test_all_of_an_arena_lies_up_to_the_edge_of_the_floor(turned):
    edge, beyond = turned(4.0, 1.0), turned(4.0 + LITTLE, 1.0)

    def made(point):
        walls = [{"name": "A", "start": point, "end": (0, 0)}, {"name": "B", "start": (0, 0), "end": point}]
        pieces = [straight(point, (0, 0)), straight((0, 0), point)]
        return arena(pieces, walls, [{"name": "C", "center": point}])

    assert paths(arena_faults(made(edge))) == []
    assert paths(arena_faults(made(beyond))) == [
        "arena.line.pieces.0.start",
        "arena.line.pieces.1.end",
        "arena.walls.0.start",
        "arena.walls.1.end",
        "arena.obstacles.0.center",
    ]


@pytest.mark.parametrize(("x_m", "is_asked"), [(4.1, False), (11.9, False), (12.1, True), (40.0, True)])
def test_of_a_point_at_three_times_the_half_floor_the_unit_is_asked_for(x_m, is_asked):
    (fault,) = arena_faults(arena(obstacles=[{"name": "A", "center": (x_m, 0.0)}]))
    assert ("in metres?" in fault.cure) is is_asked


@pytest.mark.parametrize(
    ("start_deg", "end_deg"),
    [
        (10, 80),
        (90.5, 170),
        (-80, 80),
        (80, -80),
        (100, 170),
        (-10, 190),
        (350, 370),
        (0, 360),
        (90, 180),
        (89.5, 90.5),
        (10, 89.2),
    ],
)
def test_the_points_that_are_checked_of_an_arc_reach_as_far_as_all_of_it(start_deg, end_deg):
    (piece,) = arena([arc(start_deg, end_deg, radius_m=2.0, center=(1.0, -3.0))]).line.pieces
    assert isinstance(piece, ArcPiece)
    swept = np.radians(np.linspace(start_deg, end_deg, 3601))
    whole = np.stack([1.0 + 2.0 * np.cos(swept), -3.0 + 2.0 * np.sin(swept)], axis=1)
    points = np.array(_outermost(piece))
    assert points.min(axis=0) == pytest.approx(whole.min(axis=0), abs=1e-5)
    assert points.max(axis=0) == pytest.approx(whole.max(axis=0), abs=1e-5)


def start_faults(robot, made, x_m, y_m, yaw_deg):
    route = Route.model_validate({"name": "A", "start": {"x_m": x_m, "y_m": y_m, "yaw_deg": yaw_deg}})
    return [fault.problem for fault in _start_faults(made, robot, route, ("routes", 0, "start"))]


@pytest.mark.parametrize(
    ("axis", "yaw_deg", "half_m"), [((1, 0), 0, 0.09), ((-1, 0), 90, 0.085), ((0, 1), 90, 0.09), ((0, -1), 180, 0.085)]
)
def test_a_robot_starts_with_its_whole_body_on_the_floor(robot, axis, yaw_deg, half_m):
    """0.18 m long and 0.17 m wide on a floor that ends at 4 m."""
    for out_m, problems in ((-LITTLE, []), (LITTLE, ["the robot stands beyond the edge of the floor"])):
        x_m, y_m = (unit * (4.0 - half_m + out_m) for unit in axis)
        assert start_faults(robot, arena(), x_m, y_m, yaw_deg) == problems
    assert start_faults(changed(robot, {"chassis.length_m": 0.25}), arena(), 3.875, 0.0, 0) == []  # in binary exact


def test_a_robot_starts_beside_walls_and_obstacles_and_not_in_them(robot):
    walls = [{"name": "W", "start": (0.5, -1), "end": (0.5, 1), "thickness_m": 0.02}]
    made = arena(walls=walls, obstacles=[{"name": "O", "center": (-0.5, 0.0), "size": (0.2, 0.2, 0.1)}])
    assert start_faults(robot, made, 0.5 - 0.09 - LITTLE, 0.0, 0) == []
    assert start_faults(robot, made, -0.4 + 0.09 + LITTLE, 0.0, 0) == []
    blocked = "the robot of route A would start inside"
    assert start_faults(robot, made, 0.5 - 0.09 + LITTLE, 0.0, 0) == [f"{blocked} wall W"]
    assert start_faults(robot, made, -0.4 + 0.09 - LITTLE, 0.0, 0) == [f"{blocked} obstacle O"]
    in_cm = arena(obstacles=[{"name": "O", "center": (-0.5, 0.0), "size": (20, 10, 20)}])
    size = "20 m x 10 m x 20 m (sizes are in metres)"
    assert start_faults(robot, in_cm, 0.0, 0.0, 0) == [f"{blocked} obstacle O of {size}"]


def test_a_window_leaves_a_lintel_of_10_cm_and_glass_of_20_cm(look):
    top_m = look.room.height_m - 0.1 - 0.2
    assert paths(look_faults(changed(look, {"window.sill_m": top_m}))) == []
    assert paths(look_faults(changed(look, {"window.sill_m": top_m + LITTLE}))) == ["look.window.sill_m"]


DARK = {
    "lamps.rows": 0,
    "lamps.flux_klm": 4.0,
    "desk_lamps.count": 0,
    "desk_lamps.flux_klm": 0.5,
    "room.furniture.tables": 1,
    "sun.illuminance_klx": 0.0,
    "sky.luminance_kcd_m2": 0.0,
}


@pytest.mark.parametrize(
    ("changes", "is_lit"),
    [
        ({}, False),
        ({"lamps.rows": 1}, True),
        ({"lamps.rows": 1, "lamps.flux_klm": 0.0}, False),
        ({"desk_lamps.count": 1}, True),
        ({"desk_lamps.count": 1, "desk_lamps.flux_klm": 0.0}, False),
        ({"desk_lamps.count": 1, "room.furniture.tables": 0}, False),
        ({"sun.illuminance_klx": 0.1}, True),
        ({"sky.luminance_kcd_m2": 0.1}, True),
    ],
)
def test_any_one_light_is_enough(look, changes, is_lit):
    assert paths(look_faults(changed(look, DARK | changes))) == ([] if is_lit else ["look.lamps"])


def test_a_floor_that_is_an_image_needs_a_file(look):
    assert paths(look_faults(changed(look, {"floor.material": "image"}))) == ["look.floor.image.file"]
    assert paths(look_faults(changed(look, {"floor.material": "image", "floor.image.file": "a.png"}))) == []

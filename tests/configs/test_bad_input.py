"""A table of bad inputs: each fault is one line that names the place, the field and something telling.

In the files, `#!` stands on the line that the message must name.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import pytest

from configs.loader import load_scenario
from symolo.core.errors import FaultsError, InputError


@dataclass(frozen=True)
class Bad:
    """A good scenario with one passage replaced, or with lines added at its end."""

    old: str
    """Regular expression."""
    new: str
    field: str
    telling: str


def added(lines: str, field: str, telling: str) -> Bad:
    return Bad(r"\Z", f"{lines}\n", field, telling)


def robot(lines: str, field: str, telling: str) -> Bad:
    return Bad("robot: nominal", f"robot:\n  extends: nominal\n  {lines}", field, telling)


def look(lines: str, field: str, telling: str) -> Bad:
    return Bad("look: classroom", f"look:\n  extends: classroom\n  {lines}", field, telling)


def sun(elevation: str, field: str, telling: str) -> Bad:
    return look(f"sun:\n    elevation_deg: {elevation} #!", f"look.sun.elevation_deg{field}", telling)


def arena(lines: str, field: str, telling: str) -> Bad:
    return Bad("arena: symolo", f"arena:\n  extends: symolo\n  {lines}", field, telling)


def piece(text: str, field: str, telling: str) -> Bad:
    return arena(f"line:\n    pieces:\n      - {text} #!", f"arena.line.pieces.0{field}", telling)


def obstacle(text: str, field: str, telling: str) -> Bad:
    return arena(f"obstacles:\n    - {text} #!", f"arena.obstacles.0{field}", telling)


RESISTANCE = "robot.motor.winding_resistance_ohm"
NO_DISTRIBUTION = "no distribution is allowed here, because"
PLANNED = f"{NO_DISTRIBUTION} the plan needs it"

CASES = {
    # Names of keys
    "unknown key at the top": Bad("seed: 7", "sed: 7 #!", "sed", "did you mean seed"),
    "unknown key far down": robot(
        "motor:\n    winding_resistence_ohm: 3 #!", "robot.motor.winding_resistence_ohm", "mean winding_resistance_ohm"
    ),
    "key of another place": added(
        "winding_resistance_ohm: 3 #!", "winding_resistance_ohm", f"did you mean {RESISTANCE}"
    ),
    "section of two places": added("camera: {x_m: 0.1} #!", "camera", "did you mean robot.camera or look.camera"),
    "key of a deeper and a higher place": robot("material: wood #!", "robot.material", "mean look.floor.material"),
    "unknown key before the missing one": Bad("robot: nominal", "robt: nominal #!", "robt", "did you mean robot"),
    "radius of a wheel": robot(
        "drive: {wheel_radius_m: 0.0325} #!",
        "robot.drive.wheel_radius_m",
        "did you mean wheel_diameter_m; write twice the radius",
    ),
    "diameter of the caster": robot(
        "drive: {caster_diameter_m: 0.02} #!", "robot.drive.caster_diameter_m", "mean caster_radius_m; write half"
    ),
    "pitch of the other sign": robot(
        "sensors: {left: {kind: camera, pitch_down_deg: 25}} #!",
        "robot.sensors.left.pitch_down_deg",
        "did you mean pitch_up_deg; change the sign",
    ),
    "key with the name of its section": look(
        "sun_elevation_deg: 20 #!", "look.sun_elevation_deg", "did you mean look.sun.elevation_deg"
    ),
    "section of the scenario in a route": Bad(
        "yaw_deg: -90}, runs: 2}",
        "yaw_deg: -90}, runs: 2, stop: {lap: true}} #!",
        "routes.0.stop",
        "write stop at the top of the scenario",
    ),
    "field of view as an abbreviation": robot(
        "camera: {fov_deg: 70} #!", "robot.camera.fov_deg", "did you mean field_of_view_deg"
    ),
    "extends in a subsection": robot("motor: {extends: other} #!", "robot.motor.extends", "directly in arena, robot"),
    "key given twice": added("seed: 8 #!", "seed", "given twice, first at bad.yaml:2"),
    "key given twice far down": robot(
        "motor:\n    winding_resistance_ohm: 3\n    winding_resistance_ohm: 4 #!", RESISTANCE, "first at bad.yaml:11"
    ),
    "missing field": Bad("y_m: -0.20, yaw_deg: -90}, runs: 2}", "yaw_deg: -90}} #!", "routes.0.start.y_m", "missing"),
    "missing mapping": Bad(
        "start: {x_m: 0.55, y_m: -0.20, yaw_deg: -90}, runs: 2}", "runs: 2} #!", "routes.0.start", "the fields x_m, y_m"
    ),
    # Values of the wrong type
    "text for a number": robot("motor: {winding_resistance_ohm: abc} #!", RESISTANCE, "number > 0 and <= 1000"),
    "number in quotes": robot('motor: {winding_resistance_ohm: "15"} #!', RESISTANCE, "without quotes"),
    "number with a unit": robot("drive: {track_m: 140 mm} #!", "robot.drive.track_m", "field's name: 0.14"),
    "number with another unit": robot(
        "drive: {track_m: 140 V} #!", "robot.drive.track_m", "in the unit of the field's"
    ),
    "decimal comma": robot("drive:\n    track_m: 0,14 #!", "robot.drive.track_m", "write decimals with a point, 0.14"),
    "digits in groups": robot(
        "encoder: {counts_per_revolution: 3_840} #!", "robot.encoder.counts_per_revolution", "without separators, 3840"
    ),
    "leading zeros": Bad("seed: 7", "seed: 007 #!", "seed", "without quotes or leading zeros, 7"),
    "true for a number": robot("drive: {track_m: true} #!", "robot.drive.track_m", "got true, allowed: number >= 0.03"),
    "nothing for a number": Bad("seed: 7", "seed: #!", "seed", "got nothing (null), allowed: whole number >= 0"),
    "no for false": Bad("lap: false, time_limit_s: 6}", "lap: no} #!", "stop.lap", "true or false; write false"),
    "exponent in a whole number": Bad("seed: 7", "seed: 1e5 #!", "seed", "write 100000, without a decimal point"),
    "not a number": Bad("seed: 7", "seed: .nan #!", "seed", "got '.nan', allowed: finite numbers"),
    "infinite": robot("drive: {track_m: -.inf} #!", "robot.drive.track_m", "finite numbers"),
    "larger than any float": robot("drive: {track_m: 1e999} #!", "robot.drive.track_m", "got '1e999'"),
    "longer than any integer": Bad(
        "seed: 7", f"seed: {'9' * 5000} #!", "seed", "whole numbers up to 9223372036854775807"
    ),
    "number for a name": Bad("name: trial", "name: 2025 #!", "name", "put it in quotes"),
    "name that is a path": Bad("name: CW,", "name: ../x, #!\n    ", "routes.0.name", "letters, digits, '_' and '-'"),
    "sensor with the name of a distribution": robot(
        "sensors: {normal: {kind: imu}} #!", "robot.sensors", "cannot be named uniform, normal, log_uniform, choice"
    ),
    "number for a section": Bad("arena: symolo", "arena: 3 #!", "arena", "or the path of a YAML file, or a mapping"),
    "nothing for a section": Bad("arena: symolo", "arena: #!", "arena", "got nothing (null)"),
    "mapping for a number": robot("drive: {track_m: {value: 3}} #!", "robot.drive.track_m", "allowed: a single value"),
    "mapping for a list": Bad(
        "arena: symolo", "arena: {extends: symolo, walls: {A: 1}} #!", "arena.walls", "after '- '"
    ),
    "list for a mapping": robot("motor: [1, 2] #!", "robot.motor", "a mapping with the fields winding_resistance_ohm"),
    "route without runs": Bad(
        "runs: 2}", "runs: 0} #!", "routes.0.runs", "to leave a route out, write the list `routes`"
    ),
    "empty list of routes": Bad("routes:.*(?=stop)", "routes: [] #!\n", "routes", "a list with at least 1 item"),
    # Values out of bounds
    "negative": robot("motor: {winding_resistance_ohm: -3} #!", RESISTANCE, "got -3, allowed: number > 0 and <= 1000"),
    "too large": look("sun: {elevation_deg: 91} #!", "look.sun.elevation_deg", "number >= 1 and <= 90"),
    "unknown option": obstacle("{name: A, center: [0, 0], surface: cardbord}", ".surface", "did you mean cardboard"),
    "too many coordinates": obstacle("{name: A, center: [0, 0, 0]}", ".center", "a list of 2, each number >= -50"),
    "too few coordinates": obstacle("{name: A, center: [0]}", ".center.1", "missing"),
    "text for a coordinate": obstacle("{name: A, center: [0, abc]}", ".center.1", "got 'abc'"),
    "size below zero": obstacle("{name: A, center: [0, 0], size: [1, -1, 1]}", ".size.1", "number > 0"),
    "unknown kind": piece("{kind: arch, center: [0, 0]}", ".kind", "got 'arch', allowed: one of arc, straight"),
    "missing kind": piece("{center: [0, 0]}", ".kind", "missing; allowed: one of arc, straight"),
    "unknown key of a kind": piece("{kind: arc, centre: [0, 0]}", ".centre", "did you mean center"),
    # Distributions
    "unknown distribution": sun("{unifrom: [20, 30]}", "", "did you mean uniform"),
    "two distributions": sun("{uniform: [20, 30], choice: [20]}", "", "a single value, or one of"),
    "uniform reversed": sun("{uniform: [30, 20]}", ".uniform", "got [30, 20], allowed: the lower end first"),
    "uniform of three": sun("{uniform: [20, 30, 40]}", ".uniform", "2 numbers; write {uniform: [low, high]}"),
    "uniform of text": sun("{uniform: [20, high]}", ".uniform", "2 numbers"),
    "uniform of truth": sun("{uniform: [20, true]}", ".uniform", "2 numbers"),
    "uniform of a number": sun("{uniform: 20}", ".uniform", "2 numbers"),
    "uniform beyond its bounds": sun(
        "{uniform: [0, 45]}", "", "got 0.0, allowed: number >= 1 and <= 90; it is a value"
    ),
    "log_uniform from zero": look(
        "sun: {illuminance_klx: {log_uniform: [0, 2]}} #!", "look.sun.illuminance_klx.log_uniform", "ends > 0"
    ),
    "uniform of a mapping": sun("{uniform: {low: 20}}", ".uniform", "2 numbers; write {uniform: [low, high]}"),
    "normal with negative sd": sun("{normal: [30, -2]}", ".normal", "sd >= 0; write {normal: [mean, sd]}"),
    "normal beyond its bounds": sun("{normal: [30, 10]}", "", "got -10.0, allowed: number >= 1 and <= 90"),
    "normal without end": look("lamps: {rows: {normal: [1e308, 1e308]}} #!", "look.lamps.rows.normal", "is finite"),
    "normal with an unknown key": sun("{normal: {mean: 30, std: 2}}", ".normal", "the keys mean, sd, low, high"),
    "normal without sd": sun(
        "{normal: {mean: 30}}", ".normal", "mean and sd, and low and high where wanted; write {normal: {mean: m, sd: s,"
    ),
    "normal with limits reversed": sun("{normal: {mean: 30, sd: 2, low: 31, high: 30}}", ".normal", "low below high"),
    "normal far outside its limits": sun(
        "{normal: {mean: 30, sd: 1, low: 60, high: 70}}", ".normal", "at least a thousandth"
    ),
    "choice of nothing": sun("{choice: []}", ".choice", "a list of 1 to 256 values"),
    "choice of lists": sun("{choice: [[20, 30]]}", ".choice", "numbers, names, or true and false"),
    "one option of the wrong type": sun("{choice: [20, high, 30]}", "", "got 'high'"),
    "one option out of bounds": sun("{choice: [20, 95, 30]}", "", "got 95.0"),
    "distribution for a mapping": look("sun: {uniform: [0, 1]} #!", "look.sun", "replaces one value"),
    "distribution for a list": Bad(
        "arena: symolo", "arena: {extends: symolo, walls: {choice: [1]}} #!", "arena.walls", "one value"
    ),
    "distribution for the seed": Bad("seed: 7", "seed: {uniform: [1, 9]} #!", "seed", PLANNED),
    "distribution for the runs": Bad("runs: 2}", "runs: {choice: [1, 2]}} #!", "routes.0.runs", PLANNED),
    "distribution for a rate": added("rates: {camera_hz: {choice: [5, 10]}} #!", "rates.camera_hz", PLANNED),
    "distribution for the width": added("render: {width_px: {choice: [64, 80]}} #!", "render.width_px", PLANNED),
    "distribution for a name": Bad("name: trial", "name: {choice: [a, b]} #!", "name", f"{NO_DISTRIBUTION} a name is"),
    "distribution for a text": added("licence: {choice: [a, b]} #!", "licence", f"{NO_DISTRIBUTION} text is not drawn"),
    "distribution for a kind": piece("{kind: {choice: [arc]}, center: [0, 0]}", ".kind", NO_DISTRIBUTION),
    "range for options": look("floor: {material: {uniform: [0, 1]}} #!", "look.floor.material", "only {choice: [...]}"),
    "fractions for a whole number": look("lamps: {rows: {uniform: [0.5, 2]}} #!", "look.lamps.rows", "whole numbers"),
    "range for whole steps": robot(
        "tof: {period_s: {uniform: [0.03, 0.04]}} #!", "robot.tof.period_s", "a whole number of physics steps"
    ),
    "range for whole steps of a further sensor": robot(
        "sensors: {imu: {delay_s: {uniform: [0.0, 0.01]}}} #!", "robot.sensors.imu.delay_s", "number of physics steps"
    ),
    # Fields that do not go together
    "rates not in whole numbers": added(
        "rates:\n  physics_hz: 1000\n  wheel_loop_hz: 300 #!",
        "rates.wheel_loop_hz",
        "got 300, allowed: a whole fraction",
    ),
    "rate against a default": added("rates: {control_hz: 30} #!", "rates.control_hz", "of wheel_loop_hz, which is 100"),
    "rate in the section of the camera": robot(
        "camera: {rate_hz: 30} #!", "robot.camera.rate_hz", "did you mean rates.camera_hz"
    ),
    "rate beyond its bounds": added("rates: {camera_hz: 2000} #!", "rates.camera_hz", "<= 1000"),
    "period of no whole steps": robot(
        "tof: {period_s: 0.0335} #!",
        "robot.tof.period_s",
        "got 0.0335, allowed: a whole number of physics steps of 0.001",
    ),
    "ranges reversed": robot(
        "tof:\n    min_range_m: 0.9 #!\n    max_range_m: 0.5",
        "robot.tof.min_range_m",
        "less than max_range_m, which is 0.5 (robot.tof.max_range_m is at bad.yaml:12)",
    ),
    "ranges that may be drawn reversed": robot(
        "tof:\n    max_range_m: {uniform: [0.5, 0.9]}\n    min_range_m: {uniform: [0.1, 0.6]} #!",
        "robot.tof.min_range_m",
        "got 0.6, allowed: less than max_range_m, which is 0.5",
    ),
    "camera below the floor": robot(
        "camera: {height_above_base_m: -0.2} #!",
        "robot.camera.height_above_base_m",
        "the lens is not above the floor: got -0.2, allowed: more than -0.05",
    ),
    "further camera in the floor": robot(
        "sensors: {rear: {kind: camera, z_m: 0}} #!", "robot.sensors.rear.z_m", "number > 0 and <= 2"
    ),
    "no-target value among the ranges": robot("tof: {no_target_m: 1.0} #!", "robot.tof.no_target_m", "valid range"),
    "wheels outside the chassis": robot("drive: {track_m: 0.16} #!", "robot.drive.track_m", "at most 0.15"),
    "wheels smaller than the clearance": robot(
        "drive: {wheel_diameter_m: 0.012} #!", "robot.drive.wheel_diameter_m", "more than chassis.clearance_m (0.012)"
    ),
    "chassis above its own top": robot("chassis: {clearance_m: 0.06} #!", "robot.chassis.clearance_m", "base_height_m"),
    "caster outside the chassis": robot("drive: {caster_x_m: -0.2} #!", "robot.drive.caster_x_m", "at most 0.09"),
    "robot that tips over": robot(
        "chassis: {center_of_mass_x_m: 0.01} #!", "robot.chassis.center_of_mass_x_m", "or the robot tips over"
    ),
    "motor that cannot turn": robot(
        "motor:\n    winding_resistance_ohm: 3\n    coulomb_friction_N_m: 9 #!",
        "robot.motor.coulomb_friction_N_m",
        "cannot overcome its friction",
    ),
    # 0.9 kg in 0.18 x 0.038 m pitch with m (l^2 + h^2) / 12 = 2.54e-3 kg m2; K^2 / R + B = 2.003 N m s/rad.
    "motors too strong for the step": robot(
        "motor:\n    winding_resistance_ohm: 2\n    viscous_friction_N_m_s_rad: 0.003\n    torque_constant_N_m_A: 2 #!",
        "robot.motor.torque_constant_N_m_A",
        "more than a physics step of 1 ms to stop the pitching of the body; they need 0.634 ms",
    ),
    "resistance in another unit, while the file of the robot has the torque constant": robot(
        "motor:\n    coulomb_friction_N_m: 0.02\n    winding_resistance_ohm: 0.00285 #!",
        "robot.motor.winding_resistance_ohm",
        "if it is in kohm, write 2.85",
    ),
    "corner never clear": robot(
        "controller: {corner: {front_below_m: 1.5}} #!", "robot.controller.corner.front_below_m", "front_clear_m"
    ),
    "straight piece of no length": piece("{kind: straight, start: [0, 0], end: [0, 0]}", "", "of no length"),
    "arc of no length": piece(
        "{kind: arc, center: [0, 0], radius_m: 1, start_deg: 9, end_deg: 9}", "", "end_deg other than start_deg"
    ),
    "arc over itself": piece(
        "{kind: arc, center: [0, 0], radius_m: 1, start_deg: 0, end_deg: 400}", "", "got 400.0, allowed: at most 360"
    ),
    "arc tighter than its line": arena(
        "line:\n    width_m: 0.1\n    pieces:\n"
        "      - {kind: arc, center: [0, 0], radius_m: 0.04, start_deg: 0, end_deg: 90} #!",
        "arena.line.pieces.0.radius_m",
        "more than half the line's width of 0.1",
    ),
    "wall of no length": arena(
        "walls:\n    - {name: A, start: [1, 0], end: [1, 0]} #!", "arena.walls.0", "of no length"
    ),
    "one name for two boxes": obstacle("{name: A1, center: [0, 0]}", ".name", "the same name as arena.walls.0"),
    "obstacle beyond the floor": obstacle("{name: A, center: [5, 0]}", ".center", "enlarge arena.floor.half_extent_m"),
    "line in centimetres": piece(
        "{kind: straight, start: [0, 0], end: [150, 0]}", ".end.0", "is it in metres? 150 cm are 1.5, 150 mm are 0.15"
    ),
    "obstacle in centimetres": obstacle(
        "{name: A, center: [40, 30]}", ".center", "are the lengths of the arena in metres? If they are, move it or"
    ),
    "arc beyond the floor": piece(
        "{kind: arc, center: [3.5, 0], radius_m: 1, start_deg: 0, end_deg: 90}", "", "beyond the edge of the floor"
    ),
    "arc beyond the floor at neither of its ends": piece(
        "{kind: arc, center: [3.5, 0], radius_m: 1, start_deg: -80, end_deg: 80}", "", "got [4.5, 0.0]"
    ),
    "start beyond the floor": Bad("{x_m: 0.55", "{x_m: 3.95 #!\n   ", "routes.0.start", "beyond the edge of the floor"),
    "start inside an obstacle": Bad(
        "start: {x_m: 0.55, y_m: -0.20, yaw_deg: -90}",
        "start: {x_m: 0.55, y_m: 0.03, yaw_deg: -90} #!\n   ",
        "routes.0.start",
        "start inside obstacle O2",
    ),
    "start inside a wall": Bad(
        "start: {x_m: 0.55, y_m: -0.20, yaw_deg: -90}",
        "start: {x_m: -0.3, y_m: 0.95, yaw_deg: 0} #!\n   ",
        "routes.0.start",
        "start inside wall A1",
    ),
    "window above the ceiling": look(
        "room: {height_m: 2}\n  window: {sill_m: 3} #!",
        "look.window.sill_m",
        "the window does not fit below the ceiling: got 3.0, allowed: at most 1.7, room.height_m",
    ),
    "window that may be drawn into the ceiling": look(
        "window:\n    sill_m: {uniform: [1, 2.5]} #!", "look.window.sill_m", "got 2.5, allowed: at most 2.3"
    ),
    "no light at all": look(
        "sun: {illuminance_klx: 0}\n  sky: {luminance_kcd_m2: 0}\n  lamps: {rows: 0} #!",
        "look.lamps",
        "there is no light",
    ),
    "a desk lamp and no table for it": look(
        "sun: {illuminance_klx: 0}\n  sky: {luminance_kcd_m2: 0}\n  desk_lamps: {count: 1}\n"
        "  room: {furniture: {tables: 0}}\n  lamps: {rows: 0} #!",
        "look.lamps",
        "there is no light",
    ),
    "two routes of one folder": Bad("name: CCW", "name: cw #!\n   ", "routes.1.name", "the same name as routes.0"),
    "lens that folds the image": robot(
        "camera: {distortion: {k1: -0.5}} #!", "robot.camera.distortion", "folds the image back on itself"
    ),
    # References
    "unknown shipped name": Bad("arena: symolo", "arena: symlo #!", "arena", "did you mean symolo"),
    "unknown file": Bad("look: classroom", "look: clasroom.yaml #!", "look: no such file", "did you mean classroom"),
    "name of a file beside": Bad("look: classroom", "look: bad #!", "look", "did you mean ./bad.yaml"),
    "section that extends nothing known": Bad(
        "look: classroom", "look: {extends: clasroom} #!", "look.extends", "mean classroom"
    ),
    "extends of an unknown name": added("extends: smok #!", "extends", "did you mean smoke"),
    "extends of a missing file": added("extends: base/none.yaml #!", "extends: no such file", "got 'base/none.yaml'"),
    "extends of itself": added("extends: ./bad.yaml #!", "extends", "bad.yaml -> bad.yaml"),
    "extends of a number": added("extends: 3 #!", "extends", "the name or path of one scenario"),
    "extends of a list": added("extends: [smoke, symolo] #!", "extends", "the name or path of one scenario"),
    # YAML
    "anchor": Bad("seed: 7", "seed: &a 7 #!", "seed", "anchors are not read"),
    "alias": Bad("seed: 7", "seed: *a #!", "seed", "aliases are not read"),
    "tag": Bad("seed: 7", "seed: !!float 7 #!", "seed", "got '!!float'; tags are not read"),
    "tag that runs code": added("x: !!python/object/apply:os.system [ls] #!", "x", "tags are not read"),
    "merge key": added("<<: {seed: 8} #!", "<<", "use 'extends:'"),
    "second document": added("--- #!\nname: other", "a second document begins here", "one a file"),
    "tab": added("rates:\n\tphysics_hz: 1000 #!", "not valid YAML", "indent with spaces"),
    "wrong indentation": added(
        "rates:\n  physics_hz: 1000\n   camera_hz: 5 #!", "not valid YAML", "check the indentation"
    ),
    "colon in a text": added("description: a: b #!", "not valid YAML", "put text that contains ': ' in quotes"),
    "open quote": added("description: 'abc #!", "not valid YAML", "close the quotes"),
    "open bracket": added("rates: {physics_hz: 1000 #!", "not valid YAML", "close the bracket"),
    "key without colon": added("rates #!\nstop: 3", "not valid YAML", "write a colon"),
    "key that is a list": added("? [a, b] #!\n: 3", "top level", "text as key"),
    "control character": added("description: a\x07b #!", "character '\\x07'", "remove it"),
    "too deep": added(f"x: {'[' * 40}{']' * 40} #!", "x.0.0...: nested too deep", "32 levels"),
    "alias bomb": added("a: &a [x, x] #!\nb: &b [*a, *a]\nc: [*b, *b]", "a", "anchors are not read"),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES.keys())
def test_each_fault_is_one_line_with_place_and_field(case: Bad, here: Path, scenario_text: str):
    text = re.sub(case.old, lambda _: case.new, scenario_text, count=1, flags=re.DOTALL)
    assert text != scenario_text
    (here / "bad.yaml").write_text(text)
    line = next(number for number, line in enumerate(text.splitlines(), 1) if "#!" in line)

    with pytest.raises(InputError) as caught:
        load_scenario("bad.yaml")

    several = isinstance(caught.value, FaultsError)
    message = str(caught.value.faults[0] if several else caught.value)
    expected = f"bad.yaml:{line}: {case.field}"
    assert message.startswith(expected)
    assert message[len(expected)] in ":; "
    assert case.telling in message
    assert len(message.splitlines()) == 1
    assert len(message) < 500


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        (
            "robot.motor.winding_resistance_ohm=900",
            "robot.motor.coulomb_friction_N_m: the motor cannot overcome its friction: got 0.017421774,",
        ),
        (
            "robot.tof.max_range_m=0.03",
            "robot.tof.min_range_m: got 0.04, allowed: less than max_range_m, which is 0.03",
        ),
        ("robot.tof.max_range_m=5", "robot.tof.no_target_m: got 2.0, allowed: values outside the valid range,"),
        ("robot.camera.distortion.k1=-1", "robot.camera.distortion: the lens folds"),
        (
            "robot.motor.torque_constant_N_m_A=0.003",
            "robot.motor.coulomb_friction_N_m: the motor cannot overcome its friction: got 0.017421774,",
        ),
        (
            "robot.power.motor_voltage_limit_V=0.05",
            "robot.motor.coulomb_friction_N_m: the motor cannot overcome its friction: got 0.017421774,",
        ),
        ("robot.drive.wheel_width_m=0.1", "robot.drive.track_m: got 0.14, allowed: at most 0.07, chassis.width_m"),
        ("rates.wheel_loop_hz=50", "rates.control_hz: got 20, allowed: a whole fraction of wheel_loop_hz"),
    ],
)
def test_a_setting_that_contradicts_a_file_is_at_fault_and_not_the_file(setting, message):
    with pytest.raises(InputError) as error:
        load_scenario("symolo", [setting])
    assert str(error.value).startswith(f"--set {setting.partition('=')[0]}: {message}")


@pytest.mark.parametrize(
    ("setting", "got", "cure"),
    [
        ("robot.motor.viscous_friction_N_m_s_rad=2.7", "2.7", "if it is in mN m s/rad, write 0.0027; otherwise check"),
        ("robot.motor.winding_resistance_ohm=0.00285", "0.00285", "if it is in kohm, write 2.85; otherwise check"),
        ("robot.motor.torque_constant_N_m_A=31", "31.0", "if it is in mN m/A, write 0.031; otherwise check"),
        ("robot.motor.torque_constant_N_m_A=4", "4.0", "; check the motor's parameters"),
    ],
)
def test_the_motor_parameter_that_was_set_is_named_when_the_motors_are_too_strong(setting, got, cure):
    with pytest.raises(InputError) as error:
        load_scenario("symolo", [setting])
    message = next(line for line in str(error.value).splitlines() if "too strong" in line)
    assert message.strip().startswith(f"--set {setting.partition('=')[0]}: the motors are too strong")
    assert f": got {got}, allowed: values with which" in message
    assert cure in message
    assert len(message) < 600


def test_a_key_of_another_section_is_no_setting_of_robots_from_a_diagnosis():
    with pytest.raises(InputError, match=r"robot\.encoder\.noise: unknown key; allowed: .*dropout_probability$"):
        load_scenario("smoke", ["robot.encoder.noise=2"])


@pytest.mark.parametrize("sensor", ["tof", "line_sensor", "encoder"])
def test_a_rate_in_place_of_the_period_is_the_only_fault(sensor):
    with pytest.raises(InputError) as error:
        load_scenario("smoke", [f"robot.{sensor}.rate_hz=25"])
    message = str(error.value)
    assert message.startswith(f"--set robot.{sensor}.rate_hz: unknown key; allowed: ")
    assert message.endswith("; did you mean period_s; write 1 / rate_hz, such as 0.04")
    assert "missing" not in message

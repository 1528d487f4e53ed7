"""Design of a drive: closed manoeuvres, their separation in closed form, and the files of `symolo next`."""

import ast
import csv
import json
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from configs.draw import draw_robot
from configs.loader import load_scenario, load_section
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.measured.case_files.nominal import KnownRoom, NominalMovingMotor
from diagnosis.next_trial.drive_files import drive_files
from diagnosis.next_trial.library import drive_log
from diagnosis.next_trial.library.manoeuvres import Reach, manoeuvres, path_of
from diagnosis.next_trial.limits import limits_of
from diagnosis.next_trial.separation import ModelOfUnits, UnitStatistics
from diagnosis.nominal_robot import nominal_robot
from diagnosis.predictors.pose.by_counts import LEVER_M, STRIDE, WINDOW, Pose
from physics.effects.wheels_and_floor.wheel_radius_asymmetry import WheelRadiusAsymmetry
from physics.effects.wheels_and_floor.wheelbase_scale import WheelbaseScale
from pipeline.cli import main
from pipeline.diagnosing.made_from import MADE_FROM
from symolo.core.errors import InputError

TRACK_M, RADIUS_M, TICKS = 0.16, 0.03, 3600
XY_M, THETA_RAD = 0.001, 0.003
TOP_M_S = 0.3
WHEELBASE, ASYMMETRY = (WheelbaseScale, "scale", 1.0), (WheelRadiusAsymmetry, "asymmetry", 0.0)
SCALES = {"wheelbase_scale", "wheel_radius_scale"}
NOMINAL = f"""kind: drive_log
robot:
  wheel_radius_m: {{value: {RADIUS_M}, tolerance: 0.00001}}
  wheel_separation_m: {{value: {TRACK_M}, tolerance: 0.00001}}
  encoder_ticks_per_revolution: {TICKS}
noise:
  wheel_speed_rad_s: 0.05
  pose_xy_m: {XY_M}
  pose_theta_rad: {THETA_RAD}
  travel_m_per_sqrt_m: 0
  tof_polynomial_mm: [1, 0, 0, 0]
  tof_polynomial_origin_m: 0
"""


@pytest.fixture(scope="module")
def turning_case(tmp_path_factory):
    """A robot that turned on the spot alone, and by 4 % less than its nominal wheels say."""
    folder = tmp_path_factory.mktemp("turning") / "drive"
    folder.mkdir()
    (folder / "nominal.yaml").write_text(NOMINAL)
    noise = np.random.default_rng(5)
    columns = "trial,split,session_time_s,t_s,v_cmd_m_s,w_cmd_rad_s,u_left_V,u_right_V,enc_left_ticks,enc_right_ticks"
    lines = [columns + ",tof_front_m,tof_left_m,tof_right_m,x_m,y_m,theta_rad"]
    wheel_rad = np.cumsum(TOP_M_S / RADIUS_M * 0.05 * np.sin(0.05 * np.arange(121)))
    for row, angle in enumerate(wheel_rad.tolist()):
        ticks = round(TICKS * angle / (2.0 * np.pi))
        x_m, y_m = 0.5 + XY_M * noise.standard_normal(2)
        theta_rad = 0.96 * 2.0 * RADIUS_M * angle / TRACK_M + THETA_RAD * noise.standard_normal()
        t_s = 0.05 * row
        lines.append(f"1,fit,{t_s:.2f},{t_s:.2f},,,,,{-ticks},{ticks},,,,{x_m:.5f},{y_m:.5f},{theta_rad:.5f}")
    (folder / "data.csv").write_text("\n".join(lines) + "\n")
    return folder


@pytest.fixture(scope="module")
def template(turning_case):
    return read_measurement(turning_case, IMPORTERS)


@pytest.fixture(scope="module")
def designed(turning_case):
    """The output of `symolo next` for one manoeuvre of 4 s on a floor of 1 m by 0.8 m."""
    made = record(turning_case)
    out = made.parent / "next"
    assert main([*f"next {made} --rows 1 --row-seconds 4 --floor 1x0.8 --out {out}".split()]) == 0
    return out


def record(case):
    made = case.parent / "diagnosis"
    made.mkdir(exist_ok=True)
    (made / MADE_FROM).write_text(json.dumps({"cases": [str(case)]}))
    return made


def rows_of(file):
    return list(csv.DictReader(file.read_text().splitlines()))


def test_every_manoeuvre_ends_where_it_began_and_keeps_the_limits():
    reach = Reach(rows=100, speed_m_s=TOP_M_S, turn_rad_s=3.0, track_m=TRACK_M, half_floor_m=(0.4, 0.25))
    listed = list(manoeuvres(reach))
    for words in ("straight", "on the spot", "an arc to the left", "circle", "square", "eight", "S-curve", "pushes"):
        assert any(words in each.title for each in listed), words
    for each in listed:
        assert each.commands.shape == (100, 2)
        path = path_of(each.commands, np.zeros(3))
        whole = path[-1, 2] / (2.0 * np.pi)
        assert np.hypot(*path[-1, :2]) < 2e-3, each.title
        assert whole == pytest.approx(round(whole), abs=2e-3), each.title
        assert np.all(np.abs(path[:, :2]).max(axis=0) <= (0.4, 0.25)), each.title
        rim_m_s = np.abs(each.commands[:, 0]) + 0.5 * TRACK_M * np.abs(each.commands[:, 1])
        assert rim_m_s.max() < TOP_M_S + 1e-3, each.title
        assert np.abs(each.commands[:, 1]).max() < 3.0 + 1e-3, each.title


def test_the_title_of_a_turn_on_the_spot_has_its_angle():
    """Each way lasts 50 rows of 50 ms and has two ramps of 4 rows, which count as 3 rows less at the full rate."""
    titles = [each.title for each in manoeuvres(Reach(100, TOP_M_S, 2.0, TRACK_M, (0.4, 0.25)))]
    degrees = round(np.rad2deg(2.0 * 0.05 * 47))
    assert f"a turn on the spot to the left and back at 2 rad/s, by {degrees} degrees" in titles
    assert "turning on the spot to the left at 1.3 rad/s, 1 whole turn" in titles
    assert not any("degrees" in title for title in titles if "arc" in title or "straight" in title)


def test_a_path_of_constant_curvature_is_an_arc_of_a_circle():
    quarter = np.tile([0.2 * np.pi / 4.0, np.pi / 4.0], (40, 1))  # 2 s at a radius of 0.2 m
    assert path_of(quarter, np.array([1.0, 0.0, 0.0]))[-1] == pytest.approx([1.2, 0.2, 0.5 * np.pi])


def separation(template, title, truth, rival):
    """Return the separation of two robots by one manoeuvre, with the size of the rival's effect free, and the plan."""
    library = drive_log(template, limits_of(template, rows=1, row_s=5.0, floor_m=(3.0, 3.0)), [])
    unit = next(k for k, each in enumerate(library.titles) if each.startswith(title))
    trial = library.composed(np.array([unit]))
    base_robot = draw_robot(load_section("robot", "nominal"), 0, "test")[0]
    nominal = nominal_robot(template.nominal, base_robot)
    evidence = Evidence([Pose(trial, nominal)])
    kind, number, null = rival
    robots = [nominal.with_effect(truth), nominal, nominal.with_effect(kind.model_construct(**{number: null + 1e-4}))]
    means = evidence.predicted(robots).mean / evidence.sd
    a = ModelOfUnits(means[0], np.empty((0, len(evidence.sd))), np.empty((0, 0)), 0.5, np.empty(0, bool))
    slope = (means[2] - means[1])[None] / 1e-4
    b = ModelOfUnits(means[1], slope, 1e-9 * np.eye(1), 0.5, np.ones(1, bool))
    statistics = UnitStatistics([a, b], np.zeros(len(evidence.sd), dtype=np.int64), 1)
    return statistics.separations(statistics.of_units.total())[0], trial.trials[0]


def over_windows(values):
    first = np.arange(0, len(values) - WINDOW, STRIDE)
    return values[first + WINDOW] - values[first]


def test_a_straight_drive_separates_unequal_wheels_from_a_wide_wheelbase_by_the_heading_that_they_lose(template):
    """By unequal wheels, a distance d turns by a d / b and moves sideways by a d^2 / (2 b); no wheelbase does."""
    asymmetry = 1e-3
    sigma, plan = separation(template, "straight", WheelRadiusAsymmetry.model_construct(asymmetry=asymmetry), WHEELBASE)
    # A robot that is reversed goes back on the same arc, so that the net distance of a window counts.
    distance_m = over_windows(plan["x_m"].values)
    turned, sideways = asymmetry * distance_m / TRACK_M, asymmetry * distance_m**2 / (2.0 * TRACK_M)
    squares = np.sum(turned**2) / (2.0 * THETA_RAD**2)
    squares += np.sum(sideways**2) / (2.0 * XY_M**2 + (LEVER_M * THETA_RAD) ** 2)
    assert sigma == pytest.approx(np.sqrt(squares), rel=1e-3)


def test_a_turn_on_the_spot_separates_a_wide_wheelbase_from_unequal_wheels_by_its_angle(template):
    """A wheelbase s b turns by an angle of 1 / s of the nominal one, and unequal wheels turn by the same angle."""
    scale = 1.01
    sigma, plan = separation(template, "turning on the spot", WheelbaseScale.model_construct(scale=scale), ASYMMETRY)
    lost_rad = over_windows(plan["theta_rad"].values) * (1.0 - 1.0 / scale)
    assert sigma == pytest.approx(np.sqrt(np.sum(lost_rad**2) / (2.0 * THETA_RAD**2)), rel=1e-3)


def test_a_straight_drive_shows_no_wheelbase(template):
    sigma, _ = separation(template, "straight", WheelbaseScale.model_construct(scale=1.01), ASYMMETRY)
    assert sigma == pytest.approx(0.0, abs=1e-6)


def test_a_drive_straight_on_is_chosen_where_only_turns_on_the_spot_were_driven(designed):
    """On the spot, small wheels and a wide wheelbase turn by the same angle; ahead, only small wheels fall short."""
    expected = json.loads((designed / "expected.json").read_text())
    names = {model["name"] for model in expected["models"]}
    assert {"wheelbase_scale", "wheel_radius_scale"} <= names
    assert min(pair["separation"] for pair in expected["pairs"] if {pair["truth"], pair["rival"]} == SCALES) > 5.0
    rows = rows_of(designed / "path.csv")
    assert max(float(row["v_cmd_m_s"]) for row in rows) > 0.1
    # The floor is 1 m by 0.8 m around the middle of the old poses, and the axle keeps a wheel separation away from it.
    assert max(abs(float(row["x_m"]) - 0.5) for row in rows) < 0.5 - TRACK_M + 0.005
    assert max(abs(float(row["y_m"]) - 0.5) for row in rows) < 0.4 - TRACK_M + 0.005


def test_the_files_of_a_drive_have_the_same_commands(designed):
    rows = rows_of(designed / "path.csv")
    commands = [(float(row["v_cmd_m_s"]), float(row["w_cmd_rad_s"])) for row in rows]
    template_rows = rows_of(designed / "trial_1" / "data.csv")
    assert len(template_rows) == len(rows) == 81
    assert all(row["enc_left_ticks"] == row["x_m"] == row["u_left_V"] == "" for row in template_rows)
    assert [float(row["v_cmd_m_s"]) for row in template_rows] == pytest.approx([v for v, _ in commands], abs=1e-4)
    controller = ast.parse((designed / "next_drive.py").read_text())
    listed = next(ast.literal_eval(node.value) for node in controller.body if isinstance(node, ast.Assign))
    played = [(v, w) for count, v, w in listed for _ in range(count)]
    assert np.array(played) == pytest.approx(np.array(commands[:-1]), abs=1e-4)
    held = re.findall(r"\{(\d+), (-?\d+), (-?\d+)\}", (designed / "wheel_speeds.h").read_text())
    right, left = np.array([pair for ms, *pair in held for _ in range(int(ms) // 50)], dtype=float).T / 1000.0
    v, w = np.array(commands[:-1]).T
    assert 0.5 * RADIUS_M * (right + left) == pytest.approx(v, abs=1e-3)
    assert RADIUS_M * (right - left) / TRACK_M == pytest.approx(w, abs=1e-3)


def test_the_scenario_starts_where_the_drive_does(designed):
    scenario = load_scenario(str(designed / "scenario.yaml"))
    first = rows_of(designed / "path.csv")[0]
    assert scenario.tree["routes"][0]["start"]["x_m"] == pytest.approx(float(first["x_m"]), abs=1e-3)


def test_a_scenario_without_images_has_the_walls_of_the_room(template):
    world = KnownRoom(room_x_m=5.0, room_y_m=1.5)
    in_room = replace(template, nominal=template.nominal.model_copy(update={"world": world}))
    limits = limits_of(in_room, rows=1)
    library = drive_log(in_room, limits, [])
    design = SimpleNamespace(trial=library.composed(np.array([0])), limits=limits, titles=library.titles[:1])
    scenario = yaml.safe_load(drive_files(design)["scenario.yaml"])
    assert scenario["rates"]["camera_hz"] == 0
    (room,) = scenario["arena"]["polygons"]
    assert sorted(map(tuple, room["points"])) == [(0.0, 0.0), (0.0, 1.5), (5.0, 0.0), (5.0, 1.5)]
    assert scenario["arena"]["floor"]["half_extent_m"] > 5.0
    assert "walls" not in scenario["arena"]


def test_limits_of_a_drive_that_leave_no_trial_are_refused(template):
    with pytest.raises(InputError, match="no manoeuvre of 5 s fits the floor"):
        drive_log(template, limits_of(template, floor_m=(0.3, 0.3)), [])
    with pytest.raises(InputError, match="1 s for a manoeuvre"):
        limits_of(template, row_s=1.0)
    with pytest.raises(InputError, match=r"--max-voltage is not used for a case of kind drive_log; allowed: .*--floor"):
        limits_of(template, max_voltage_V=3.0)


def test_a_speed_that_the_motors_do_not_reach_is_refused(template):
    """Without friction, 6 V and 0.3 V s/rad are 20 rad/s, and 0.6 m/s with wheels of 30 mm."""
    spread = {"tolerance": 0.0}
    motor = NominalMovingMotor(
        winding_resistance_ohm={"value": 3.0, **spread},
        torque_constant_N_m_A={"value": 0.3, **spread},
        viscous_friction_N_m_s_rad={"value": 0.0, **spread},
        coulomb_friction_N_m={"value": 0.0, **spread},
        rotor_inertia_kg_m2={"value": 0.003, **spread},
        supply_voltage_V=6.0,
    )
    with_motor = replace(template, nominal=template.nominal.model_copy(update={"motor": motor}))
    assert limits_of(with_motor, max_speed_m_s=0.599).max_speed_m_s == 0.599
    with pytest.raises(InputError, match=r"--max-speed: got '0.61 m/s, .*up to 0.6 m/s"):
        limits_of(with_motor, max_speed_m_s=0.61)


def test_a_robot_that_went_straight_on_so_far_may_turn_as_fast_as_half_its_speed_allows(template):
    """Both wheels at v / 2 in opposite directions turn a robot with the wheel separation b at v / b."""
    (trial,) = template.trials
    ticks = trial["enc_right_ticks"]
    both = tuple(replace(ticks, series=replace(ticks.series, name=f"enc_{side}_ticks")) for side in ("left", "right"))
    straight = replace(template, trials=(replace(trial, channels=(*both, trial["x_m"], trial["y_m"])),))
    limits = limits_of(straight)
    assert limits.max_speed_m_s == pytest.approx(limits_of(template).max_speed_m_s)
    assert limits.max_turn_rad_s == pytest.approx(limits.max_speed_m_s / TRACK_M)


def test_a_floor_that_is_no_size_is_refused(symolo, turning_case, tmp_path):
    made = record(turning_case)
    for text in ("1", "1x", "0x1", "1x60"):
        ended = symolo("next", made, "--floor", text, "--out", tmp_path / "next")
        assert ended.code == 2
        assert "--floor" in ended.err
        assert "Traceback" not in ended.err
    assert not (tmp_path / "next").exists()

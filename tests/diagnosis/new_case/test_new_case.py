"""`symolo case init`: what it writes, what it estimates, and what it reports as missing."""

import io
import re

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.effects.registry import EFFECTS
from configs.loader import load_section
from diagnosis.examples.example import FOLDER
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.measured.case_files.nominal import NominalSteady, NominalStep
from diagnosis.new_case.known_numbers import numbers_of
from diagnosis.nominal_robot import nominal_robot
from diagnosis.predictors import STAGES
from pipeline.cli import main
from tests.diagnosis.new_case.drives import RADIUS, SLOPE, TC, TICKS, TRACK, B, J, K, R, csv_text


def values(section):
    return {key: field["value"] if isinstance(field, dict) else field for key, field in section.items()}


def test_unknown_numbers_are_estimated_with_a_tolerance_in_which_no_effect_can_be_named(init, columns):
    code, out, err, nominal = init(columns, "--set", f"ticks_per_turn={TICKS}")
    assert (code, err) == (0, "")
    robot, motor, noise = nominal["robot"], nominal["motor"], nominal["noise"]
    assert values(robot)["wheel_radius_m"] == pytest.approx(RADIUS, rel=0.01)
    assert values(robot)["wheel_separation_m"] == pytest.approx(TRACK, rel=0.01)
    assert values(robot)["encoder_ticks_per_revolution"] == TICKS
    assert robot["wheel_radius_m"]["tolerance"] == pytest.approx(0.2 * RADIUS, rel=0.02)
    # The resistance cannot be seen without a current; 3 ohm is what is assumed.
    assert values(motor)["torque_constant_N_m_A"] == pytest.approx(K, rel=0.03)
    assert values(motor)["coulomb_friction_N_m"] == pytest.approx(TC, rel=0.25)
    assert values(motor)["rotor_inertia_kg_m2"] == pytest.approx(J, rel=0.25)
    assert motor["torque_constant_N_m_A"]["tolerance"] == pytest.approx(0.5 * K, rel=0.05)
    assert noise["pose_xy_m"] == pytest.approx(1e-3, rel=0.2)
    assert noise["pose_theta_rad"] == pytest.approx(3e-3, rel=0.2)
    for key, effect in (("wheel_diameter_m", "wheel_radius_scale"), ("track_m", "wheelbase_scale")):
        assert re.search(rf"^  {key} .*allows: {effect}", out, re.MULTILINE)
    assert "ticks_per_turn" not in out
    assert "symolo diagnose run --out run-diagnosis" in out


def test_known_numbers_are_taken_with_the_usual_tolerance(init, columns):
    given = {"ticks_per_turn": 1440, "wheel_diameter_m": 0.066, "track_m": 0.15, "torque_constant_N_m_A": 0.28}
    _, out, _, nominal = init(columns, *(word for key in given for word in ("--set", f"{key}={given[key]}")))
    robot = nominal["robot"]
    assert robot["wheel_radius_m"] == {"value": 0.033, "tolerance": pytest.approx(0.006 * 0.033, rel=0.01)}
    assert robot["wheel_separation_m"] == {"value": 0.15, "tolerance": pytest.approx(0.0015)}
    assert nominal["motor"]["torque_constant_N_m_A"] == {"value": 0.28, "tolerance": pytest.approx(0.014)}
    assert not re.search(r"^  (track_m|wheel_diameter_m|torque_constant)", out, re.MULTILINE)


@pytest.mark.parametrize(
    ("known", "comments"),
    [
        ({}, ("NOT KNOWN: a usual value", "NOT KNOWN: estimated from this log", "NOT KNOWN: estimated from this log")),
        (
            {"wheel_diameter_m": 2 * RADIUS},
            ("given, but the ticks were", "NOT KNOWN: estimated from this log", "NOT KNOWN: estimated from this log"),
        ),
        ({"ticks_per_turn": TICKS}, (*["NOT KNOWN: estimated from this log"] * 2, "given")),
        (
            {"ticks_per_turn": TICKS, "wheel_diameter_m": 0.07, "track_m": 0.16},
            ("given; usual tolerance", "given; usual tolerance", "given"),
        ),
    ],
)
def test_a_comment_states_whether_a_number_is_given_estimated_or_assumed(known, comments, init, columns, tmp_path):
    init(columns, *(word for key, value in known.items() for word in ("--set", f"{key}={value}")))
    text = (tmp_path / "run" / "nominal.yaml").read_text()
    names = ("wheel_radius_m", "wheel_separation_m", "encoder_ticks_per_revolution")
    for name, comment in zip(names, comments, strict=True):
        assert re.search(rf"^  {name}: .*  # {comment}", text, re.MULTILINE), text


def test_the_case_has_the_stages_of_what_was_logged(init, columns, tmp_path):
    base_robot = draw_robot(load_section("robot", "nominal"), 0, "test")[0]
    lacking = {
        "": ({"wheels", "pose"}, "not compared: ranges, because the log lacks them"),
        "motor": ({"pose"}, "not compared: speeds of the wheels from voltages, because the log lacks voltages of both"),
        "x_cm": ({"wheels", "pose"}, "not compared: changes of the pose from ticks, because the log lacks poses"),
    }
    for number, (start, (names, line)) in enumerate(lacking.items()):
        logged = {name: column for name, column in columns.items() if not start or not name.startswith(start)}
        code, out, err, _ = init(logged, "--set", "ticks_per_turn=1440", "--out", f"case_{number}")
        assert (code, err) == (0, "")
        assert line in out
        measurement = read_measurement(tmp_path / f"case_{number}", IMPORTERS)
        assert measurement.nominal is not None
        stages = STAGES[measurement.kind](measurement, nominal_robot(measurement.nominal, base_robot))
        observed = {stage.name for stage in stages if any(o.usable.any() for o in stage.observed)}
        assert observed == names - ({"pose"} if start == "x_cm" else set())


def test_one_range_sensor_with_room_and_mount_is_compared(init, columns, tmp_path):
    logged = {**columns, "tof_front_mm": np.full(600, 500), "tof_left_mm": np.full(600, 400)}
    mount = ("front_x_m=0.08", "front_y_m=0", "front_yaw_deg=90", "room_x_m=3", "room_y_m=2", "ticks_per_turn=1440")
    _, out, _, nominal = init(logged, *(word for setting in mount for word in ("--set", setting)))
    assert "compared: range of the front sensor" in out
    assert "not compared: range of the left sensor, because left_x_m, left_y_m, left_yaw_deg not given" in out
    assert nominal["tof"]["mount"] == {"front": {"x_m": 0.08, "y_m": 0, "yaw_rad": pytest.approx(np.pi / 2, abs=1e-5)}}
    assert nominal["world"] == {"room_x_m": 3, "room_y_m": 2}
    (trial,) = read_measurement(tmp_path / "run", IMPORTERS).trials
    np.testing.assert_allclose(trial["tof_left_m"].values, 0.4)


def test_without_poses_the_ticks_per_turn_cannot_be_guessed(init, columns):
    logged = {name: column for name, column in columns.items() if not name.endswith(("_cm", "_deg"))}
    code, _, err, nominal = init(logged)
    assert (code, nominal) == (2, {})
    assert re.search(r"ticks_per_turn is missing.*give it with --set ticks_per_turn=NUMBER", err)


def test_every_wrong_setting_is_reported(init, columns):
    code, _, err, _ = init(columns, "--set", "trak_m=0.14", "--set", "wheel_diameter_m=65")
    assert code == 2
    assert re.search(r"'trak_m=0.14'.*did you mean track_m", err)
    assert re.search(r"wheel_diameter_m: got '65', allowed: a number, above 0 to 0.5", err)


def test_a_number_that_does_not_matter_for_the_log_is_noted(init, columns):
    code, out, _, nominal = init(columns, "--set", "ticks_per_turn=1440", "--set", "room_x_m=2")
    assert code == 0
    assert "note: not needed for what was logged: room_x_m" in out
    assert "world" not in nominal


def test_a_corrected_mapping_is_taken_again(init, columns, tmp_path):
    init(columns, "--set", "ticks_per_turn=1440")
    path = tmp_path / "run" / "mapping.yaml"
    path.write_text(path.read_text().replace('x_m: {column: "x_cm", unit: "cm"}', "x_m: {column: x_cm, unit: mm}"))
    code, _, err, _ = init(columns, "--mapping", "run/mapping.yaml", "--out", "again", "--set", "ticks_per_turn=1440")
    assert (code, err) == (0, "")
    first, again = (read_measurement(tmp_path / name, IMPORTERS).trials[0] for name in ("run", "again"))
    np.testing.assert_allclose(again["x_m"].values, 0.1 * first["x_m"].values)
    np.testing.assert_array_equal(again["y_m"].values, first["y_m"].values)


def test_a_check_is_the_first_thing_that_each_command_prints(init, columns, capsys, tmp_path):
    """Exchanged wheels turn the other way; inspect reads the case only."""
    swapped = {**columns, "enc_l": columns["enc_r"], "enc_r": columns["enc_l"]}
    _, out, _, _ = init(swapped, "--set", f"ticks_per_turn={TICKS}")
    check = "CHECK theta_rad turns against the wheels"
    assert out.splitlines()[1].startswith(check)
    assert [note.split(":")[0] for note in read_measurement(tmp_path / "run", IMPORTERS).checks] == [check]
    assert main(["inspect", str(tmp_path / "run")]) == 0
    assert any(line.startswith(check) for line in capsys.readouterr().out.splitlines()[:4])


@pytest.mark.parametrize(("ticks", "times"), [(360, "4 times"), (720, "2 times"), (2880, "0.5 times")])
def test_ticks_of_other_edges_of_the_encoder_are_named(ticks, times, init, columns):
    known = (f"ticks_per_turn={ticks}", f"wheel_diameter_m={2 * RADIUS}", f"track_m={TRACK}")
    _, out, _, _ = init(columns, *(word for setting in known for word in ("--set", setting)))
    (check,) = re.findall(r"CHECK.*", out)
    assert f"with ticks_per_turn 1440, {times} as many" in check


@pytest.mark.parametrize(("share", "words"), [(0.5, "twice as much"), (2.0, "half as much"), (0.6, "")])
def test_another_track_is_named_with_the_one_that_fits(share, words, init, columns):
    known = (f"ticks_per_turn={TICKS}", f"wheel_diameter_m={2 * RADIUS}", f"track_m={share * TRACK}")
    _, out, _, _ = init(columns, *(word for setting in known for word in ("--set", setting)))
    fits = r"CHECK track_m: theta_rad turns (.*) times as far .* a distance of (.*) m between the wheels(.*)"
    ((ratio, track_m, text),) = re.findall(fits, out)
    assert float(ratio) == pytest.approx(share, rel=0.01)
    assert float(track_m) == pytest.approx(TRACK, rel=0.01)
    assert words in text


def test_a_wrong_unit_is_the_only_sign_though_the_places_do_not_follow_the_heading_either(init, columns):
    known = (f"ticks_per_turn={TICKS}", f"wheel_diameter_m={2 * RADIUS}", f"track_m={TRACK}")
    radians = {**columns, "heading_deg": np.unwrap(np.radians(columns["heading_deg"]))}
    _, out, _, _ = init(radians, *(word for setting in known for word in ("--set", setting)))
    assert re.findall(r"CHECK ([^:]*)", out) == ["THE UNIT of theta_rad"]


@pytest.mark.parametrize(("named", "factor"), [("heading_rad", 1.0), ("heading_deg", np.pi / 180.0)])
def test_a_wrapped_heading_in_another_unit_than_its_name_says_is_found_by_the_turns(named, factor, init, columns):
    known = (f"ticks_per_turn={TICKS}", f"wheel_diameter_m={2 * RADIUS}", f"track_m={TRACK}")
    logged = {name: column for name, column in columns.items() if name != "heading_deg"}
    logged[named] = np.round(factor * columns["heading_deg"], 6)
    _, out, _, _ = init(logged, *(word for setting in known for word in ("--set", setting)))
    (check,) = re.findall(r"CHECK (.*)", out)
    assert re.match(r"THE UNIT of theta_rad: it is about (57\.|0\.0174)", check)


def test_a_gap_is_noted_and_is_no_jump_of_a_counter(init, columns):
    logged = {name: np.delete(column, slice(200, 260)) for name, column in columns.items()}
    _, out, _, _ = init(logged, "--set", f"ticks_per_turn={TICKS}")
    assert "CHECK" not in out
    assert re.search(r"1 gap of time is more than 10 times as long; the longest gap is 3.05 s, from t = 9.950 s", out)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: {**c, "heading_deg": -c["heading_deg"]}, "theta_rad turns against the wheels"),
        (lambda c: {**c, "enc_l": c["enc_r"], "enc_r": c["enc_l"]}, "theta_rad turns against the wheels"),
        (lambda c: {**c, "heading_deg": c["heading_deg"] + 90}, "x_m and y_m do not move where theta_rad points"),
        (lambda c: {**c, "enc_l": -c["enc_r"], "enc_r": -c["enc_l"]}, "the pose moves backwards while the ticks grow"),
        (lambda c: {**c, "heading_deg": 10 * np.sin(np.arange(600))}, "theta_rad does not follow the wheels"),
        (lambda c: {**c, "enc_r": -c["enc_r"]}, "enc_right_ticks has the wrong sign"),
        (lambda c: {**c, "enc_l": -c["enc_l"]}, "enc_left_ticks has the wrong sign"),
        (lambda c: {**c, "motor_l [mV]": -c["motor_l [mV]"]}, "u_left_V and enc_left_ticks"),
        (
            lambda c: {**c, "motor_l [mV]": c["motor_r [mV]"], "motor_r [mV]": c["motor_l [mV]"]},
            "u_left_V and u_right_V",
        ),
        (lambda c: c, ""),
    ],
)
def test_mixed_up_sides_and_signs_are_reported(change, message, init, columns):
    _, out, _, _ = init(change(columns), "--set", "ticks_per_turn=1440")
    assert re.findall(r"CHECK ([^:;]*)", out) == ([message] if message else [])


def test_a_log_without_poses_leaves_open_whose_sign_is_wrong(init, columns):
    logged = {name: column for name, column in columns.items() if name[:4] in {"time", "enc_", "moto"}}
    _, out, _, _ = init({**logged, "enc_r": -logged["enc_r"]}, "--set", "ticks_per_turn=1440")
    (check,) = re.findall("CHECK (.*)", out)
    assert check.startswith("u_right_V and enc_right_ticks: the right wheel turns against its voltage; give the one")


def test_in_a_terminal_the_command_asks_and_enter_leaves_a_number_out(init, columns, monkeypatch):
    answers = ["1440", "", "far", "0.14"]
    answers += [""] * 20
    monkeypatch.setattr("sys.stdin", io.StringIO("\n".join(answers) + "\n"))
    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    code, out, _, nominal = init(columns)
    assert code == 0
    assert "track_m: got 'far', allowed: a number, above 0 to 1" in out
    assert nominal["robot"]["wheel_separation_m"] == {"value": 0.14, "tolerance": pytest.approx(0.0014)}
    assert nominal["robot"]["encoder_ticks_per_revolution"] == 1440
    assert re.search(r"^  wheel_diameter_m ", out, re.MULTILINE)


def test_a_supply_that_the_user_types_scales_the_duty_cycles(init, columns, monkeypatch, tmp_path):
    duties = {f"pwm_{side}": np.round(columns[f"motor_{side} [mV]"] / 9.1e3 * 255).astype(int) for side in "lr"}
    logged = {name: column for name, column in columns.items() if not name.startswith("motor")} | duties
    answers = {"supply_voltage_V": "9.1", "ticks_per_turn": "1440"}
    asked = []
    monkeypatch.setattr("typer.prompt", lambda text, **_: asked.append(text) or answers.get(text.split(", ")[-1], ""))
    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    code, out, err, nominal = init(logged)
    assert (code, err) == (0, "")
    assert nominal["motor"]["supply_voltage_V"] == 9.1
    (trial,) = read_measurement(tmp_path / "run", IMPORTERS).trials
    np.testing.assert_allclose(trial["u_left_V"].values, 1e-3 * columns["motor_l [mV]"], atol=0.5 * 9.1 / 255 + 1e-4)
    assert "times 9.1 V" in out
    assert "give it" not in out
    assert "7.4" not in out
    assert len(asked) == len(set(asked))


def test_a_supply_that_is_not_known_is_asked_for(init, columns):
    logged = {name.replace("motor", "pwm").replace(" [mV]", ""): column for name, column in columns.items()}
    _, out, _, _ = init(logged, "--set", "ticks_per_turn=1440")
    assert "times a supply of 7.4 V, which is not known: give it with --set supply_voltage_V=NUMBER" in out


def test_a_material_may_have_any_name(init):
    names = ['matt "grey" #2', "back\\slash: black", "{white}"]
    columns = {
        "distance_m": np.repeat([0.1, 0.2, 0.3], 8),
        "reading_m": np.repeat([0.12, 0.21, 0.33], 8),
        "material": np.repeat(names, 8),
    }
    code, out, err, nominal = init(columns)
    assert (code, err) == (0, ""), out
    assert nominal["tof"]["reflectance"] == dict(zip(sorted(names), (0.05, 0.18, 0.85), strict=True))


def test_logs_with_strange_values_are_read_or_refused(columns, tmp_path, monkeypatch, capsys):
    """Never a traceback: each of these damaged logs gives a case that can be read, or a message."""
    monkeypatch.chdir(tmp_path)
    rng = np.random.Generator(np.random.PCG64(3))
    cells = ["", "nan", "0", "-1", "1e30", "7", "-3.5", "100000", "x"]
    names = list(columns)
    codes = []
    for number in range(15):
        damaged = {name: column[:80].astype(object) for name, column in columns.items()}
        for _ in range(int(rng.integers(1, 4))):
            name, cell = names[int(rng.integers(len(names)))], cells[int(rng.integers(len(cells)))]
            rows = slice(None) if rng.random() < 0.3 else int(rng.integers(80))
            damaged[name][rows] = cell
        (tmp_path / "log.csv").write_text(csv_text(damaged))
        codes.append(main(["case", "init", "log.csv", "--out", f"case_{number}", "--set", "ticks_per_turn=1440"]))
        assert (tmp_path / f"case_{number}").is_dir() == (codes[-1] == 0)
    assert set(codes) == {0, 2}
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.parametrize("sweeps", [1, 2])
def test_the_noise_of_a_motor_in_steady_states_is_estimated(sweeps, init):
    """The motor obeys u = R i + K w and K i = B w + Tc, where it turns; below that, it stands still and i = u / R."""
    rng = np.random.Generator(np.random.PCG64(8))
    u = np.concatenate([np.linspace(0.0, 5.0, 41)[:: 1 if sweep % 2 == 0 else -1] for sweep in range(sweeps)])
    turning = u > R * TC / K
    w = np.where(turning, (u - R * TC / K) / SLOPE, 0.0)
    columns = {
        "sweep": np.repeat(np.arange(sweeps), 41),
        "motor_V": u,
        "current_A": np.where(turning, (TC + B * w) / K, u / R) + rng.normal(0, 0.012, len(u)),
        "speed [rad/s]": w + np.where(turning, rng.normal(0, 0.15, len(u)), 0.0),
    }
    code, out, err, nominal = init(columns)
    assert (code, err) == (0, ""), out
    # Thirty to forty degrees of freedom: a standard error of 12 %.
    assert nominal["noise"]["current_A"] == pytest.approx(0.012, rel=0.35)
    assert nominal["noise"]["omega_rad_s"] == pytest.approx(0.15, rel=0.35)


def test_the_noise_of_a_few_rows_of_a_bench_is_a_usual_value(init, tmp_path):
    columns = {"motor_V": [1, 2, 3, 4], "current_A": [0.1, 0.11, 0.13, 0.14], "speed [rad/s]": [2, 5, 8, 11]}
    code, out, err, nominal = init(columns)
    assert (code, err) == (0, ""), out
    assert nominal["noise"] == {"current_A": 0.005, "omega_rad_s": 0.06}
    assert (tmp_path / "run" / "nominal.yaml").read_text().count("a usual value, since there are too few rows") == 2


def test_a_folder_in_use_stays_as_it_is(init, columns, tmp_path):
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "note.txt").write_text("mine")
    code, _, err, _ = init(columns)
    assert code == 2
    assert "is there already" in err
    assert [path.name for path in (tmp_path / "run").iterdir()] == ["note.txt"]


@pytest.mark.parametrize("name", ["motor_steady_002", "motor_step_001", "tof_bench_001"])
def test_a_bench_comes_back_from_its_rows_under_other_names(name, init, tmp_path):
    original = read_measurement(FOLDER / name, IMPORTERS)
    lines = (FOLDER / name / "data.csv").read_text().splitlines()
    header = lines[0].split(",")
    rows = list(zip(*(line.split(",") for line in lines[1:]), strict=True))
    theirs = {
        "trial": ("trial", 1),
        "sweep": ("sweep", 1),
        "t_s": ("time_ms", 1000),
        "u_cmd_V": ("motor_mV", 1000),
        "current_A": ("current (mA)", 1000),
        "omega_rad_s": ("speed [rpm]", 30 / np.pi),
        "distance_m": ("true distance [mm]", 1000),
        "reading_m": ("tof_cm", 100),
        "material": ("target", None),
        "incidence_rad": ("angle_deg", 180 / np.pi),
        "temperature_C": ("temp", 1),
        "ambient_lux": ("lux", 1),
    }
    columns = {}
    for key, cells in zip(header, rows, strict=True):
        if key in theirs:
            new, factor = theirs[key]
            columns[new] = [cell if factor is None or not cell else repr(float(cell) * factor) for cell in cells]
    code, out, err, nominal = init(columns)
    assert (code, err) == (0, ""), out
    again = read_measurement(tmp_path / "run", IMPORTERS)
    assert again.kind == original.kind == nominal["kind"]
    for before, after in zip(original.trials, again.trials, strict=True):
        for channel in before.channels:
            np.testing.assert_allclose(after[channel.name].values, channel.values, atol=2e-8)
        assert [label.values for label in after.labels] == [label.values for label in before.labels]
    assert again.heldout_rows > 0
    if "motor" in nominal:
        assert isinstance(original.nominal, NominalSteady | NominalStep)
        # Least squares of the data find the motor that made them, but for what the case hides.
        for key in ("winding_resistance_ohm", "torque_constant_N_m_A"):
            assert values(nominal["motor"])[key] == pytest.approx(getattr(original.nominal.motor, key).value, rel=0.1)


def test_what_a_number_allows_is_named_as_the_effects_are(init, columns, tmp_path):
    logged = {**columns, **{f"tof_{side}_mm": np.full(600, 500) for side in ("front", "left", "right")}}
    init(logged, "--set", "ticks_per_turn=1440")
    words = {
        word
        for number in numbers_of(read_measurement(tmp_path / "run", IMPORTERS))
        for word in re.findall(r"\w+_(?:scale|sag|slip)", number.allows)
    }
    assert len(words) > 8
    assert words <= set(EFFECTS.by_name())


@pytest.mark.parametrize(("cell", "words"), [("nan", "got 'nan'"), ("", "got ''")])
def test_a_voltage_that_was_not_logged_is_named_with_its_row_in_the_log_and_the_cure(cell, words, init):
    """A row of a serial log that was lost, in the 50th row below the header."""
    volts = np.linspace(1.0, 6.0, 100)
    columns = {"U [V]": volts.tolist(), "I [A]": np.round(0.1 + 0.01 * volts, 4).tolist()}
    columns["U [V]"][49], columns["I [A]"][49] = cell, ""
    code, _, err, folder = init(columns, "--set", "supply_voltage_V=6")
    assert (code, folder) == (2, {})
    assert err.startswith(f"symolo: run.csv: row 51: column U [V]: {words}, allowed: a number")
    assert "remove the row" in err
    assert "data.csv" not in err

"""`symolo validate`: what is written, what is printed, and what is refused."""

import contextlib
import io
import json
import subprocess
import sys

import pytest

from pipeline.cli import main

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"


@pytest.fixture(scope="module")
def validated(tmp_path_factory):
    """Motor and line sensor in one folder, as they may be: it is read only, and made once, for each takes seconds."""
    out = tmp_path_factory.mktemp("validation") / "out"
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        assert main(["validate", "motor", "--out", str(out)]) == 0
        assert main(["validate", "line-sensor", "--out", str(out), "--robot", "worn"]) == 0
    return out, printed.getvalue()


def files_of(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


@pytest.mark.parametrize(
    ("part", "robot", "line"),
    [
        ("motor", "nominal", "holds   breaks away at: 0.16017 V, expected 0.16007"),
        ("line-sensor", "worn", "holds   levels: 1024, expected 1024"),
    ],
)
def test_a_part_gives_json_figure_and_report(part, robot, line, validated):
    out, printed = validated
    assert line in printed
    files = files_of(out)
    assert set(files) == {"motor.json", "motor.png", "line-sensor.json", "line-sensor.png"}
    assert files[f"{part}.png"].startswith(PNG_SIGNATURE)
    content = json.loads(files[f"{part}.json"])
    assert (content["part"], content["seed"], content["robot"]["name"]) == (part, 1, robot)
    for experiment in content["experiments"].values():
        assert set(experiment) == {"shows", "tables", "checks", "notes"}


def test_the_same_command_writes_the_same_bytes(validated, symolo, tmp_path):
    """With the line sensor, which alone of the two draws random numbers."""
    assert symolo("validate", "line-sensor", "--out", tmp_path / "out", "--robot", "worn").code == 0
    again, before = files_of(tmp_path / "out"), files_of(validated[0])
    assert again == {name: before[name] for name in ("line-sensor.json", "line-sensor.png")}


def test_the_motor_is_written_beside_table_1_and_table_2(validated):
    tables = json.loads((validated[0] / "motor.json").read_text())["experiments"]["steady_states"]["tables"]
    assert tables["table_1"]["voltage_V"][-1] == 5.0
    table_2 = {
        "winding_resistance_ohm": 3.03,
        "torque_constant_N_m_A": 0.31,
        "viscous_friction_N_m_s_rad": 0.002,
        "coulomb_friction_N_m": 0.02,
    }
    assert table_2.items() <= tables["Table 2 as printed"].items()


def test_the_effects_of_the_robot_are_written(validated):
    content = json.loads((validated[0] / "line-sensor.json").read_text())
    assert content["robot"]["effects"]["winding_resistance_scale"] == {"scale": 1.08}


def test_a_figure_that_does_not_exist_is_null_in_the_json(validated):
    threshold = json.loads((validated[0] / "line-sensor.json").read_text())["experiments"]["threshold"]
    assert None in threshold["tables"]["line_error"]["line_error"]


def test_few_readings_of_the_range_sensor_leave_the_tables_open(symolo, tmp_path, monkeypatch):
    monkeypatch.setattr("diagnosis.validation.range_sensor.recordings.static.MODEL_READINGS", 300)
    (tmp_path / "still").mkdir()
    recording = "Fs,50.00\nLogging time,20\nd\n" + "100.0\n101.0\n99.0\n103.0\n" * 250
    (tmp_path / "still" / "recording.csv").write_text(recording)
    static = ("--readings", "10", "--static", tmp_path / "still")
    ended = symolo("validate", "range-sensor", "--out", tmp_path / "out", *static)
    assert (ended.code, ended.err) == (0, "")
    lines = [line.strip() for line in ended.out.splitlines()]
    for table in ("Table 3", "Table 4"):
        assert any(line.startswith("open ") and f"({table})" in line for line in lines)
    # The 10-90 % width of a disc of even light is 0.69 of the footprint; a beam brighter in the middle has less.
    assert any(line.startswith("MISSED  10-90 % width over the footprint") for line in lines)
    assert any(line.startswith("holds   diameter at 150 mm") for line in lines)
    assert any(line.startswith("recording.csv: Noise and drift") for line in lines)
    assert any(line.startswith("note    noise of a reading") for line in lines)
    files = files_of(tmp_path / "out")
    names = ("range-sensor", "range-sensor-recordings")
    assert set(files) == {f"{name}.{ending}" for name in names for ending in ("json", "png")}
    assert all(files[f"{name}.png"].startswith(PNG_SIGNATURE) for name in names)
    experiments = json.loads(files["range-sensor.json"])["experiments"]
    assert len(experiments["tones"]["tables"]) - 1 + len(experiments["materials"]["tables"]) == 9
    assert {check["passed"] for check in experiments["tones"]["checks"]} == {None}
    assert len(experiments["step"]["tables"]) == 6
    assert len(experiments["tilt"]["tables"]) == 2 * 6
    assert len(experiments["field_of_view"]["tables"]) == 6


BAD = {
    "no part of that name": (["moter", "--out", "OUT"], "'motor'"),
    "no folder": (["motor"], "--out"),
    "misspelt robot": (["motor", "--out", "OUT", "--robot", "nominel"], "did you mean nominal"),
    "no such robot file": (["line-sensor", "--out", "OUT", "--robot", "nowhere.yaml"], "nowhere.yaml"),
    "robot without inertia": (["motor", "--out", "OUT", "--robot", "HERE/rotor.yaml"], "rotor_inertia_kg_m2"),
    "robot with a blind sensor": (["line-sensor", "--out", "OUT", "--robot", "HERE/blind.yaml"], "threshold"),
    "robot that sees nothing": (["range-sensor", "--out", "OUT", "--robot", "HERE/near.yaml"], "no board at 100 mm"),
    "too few readings": (["range-sensor", "--out", "OUT", "--readings", "9"], "--readings"),
    "no folder of scans": (["range-sensor", "--out", "OUT", "--scan", "nowhere"], "--scan nowhere: no such folder"),
    "empty folder of scans": (["range-sensor", "--out", "OUT", "--scan", "HERE/empty"], "holds no .csv file"),
    "folder of scans is a file": (["range-sensor", "--out", "OUT", "--scan", "HERE/near.yaml"], "not a folder"),
    "no folder of recordings": (["range-sensor", "--out", "OUT", "--static", "nowhere"], "--static nowhere"),
    "recording cut off": (["range-sensor", "--out", "OUT", "--static", "HERE/cut"], "row 1003: column d: got ''"),
    "seed below zero": (["line-sensor", "--out", "OUT", "--seed", "-1"], "--seed"),
    "folder of somebody else": (["motor", "--out", "HERE"], "did not make"),
    "folder is a file": (["motor", "--out", "HERE/blind.yaml"], "is a file"),
}


@pytest.mark.parametrize("kind", BAD)
def test_bad_input_is_one_line_and_nothing_written(kind, symolo, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    here = tmp_path / "HERE"
    here.mkdir()
    (here / "rotor.yaml").write_text("extends: nominal\nname: rotor\nmotor: {rotor_inertia_kg_m2: 0.0}\n")
    (here / "blind.yaml").write_text("extends: nominal\nname: blind\nline_sensor: {threshold: 0.9}\n")
    (here / "near.yaml").write_text("extends: nominal\nname: near\ntof: {min_range_m: 0.3}\n")
    (here / "empty").mkdir()
    (here / "cut").mkdir()
    (here / "cut" / "record.csv").write_text("Fs,50.00\nLogging time,20\nd\n" + "100.0\n" * 999 + "\n" + "100.0\n")
    before = sorted(tmp_path.rglob("*"))
    arguments, message = BAD[kind]
    ended = symolo("validate", *arguments)
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith("symolo: ")
    assert ended.err.count("\n") == 1
    assert message in ended.err
    assert sorted(tmp_path.rglob("*")) == before


def test_a_folder_of_validation_experiments_is_no_dataset(validated, symolo):
    ended = symolo("simulate", "smoke", "--out", validated[0])
    assert ended.code == 2
    assert "symolo validate" in ended.err


@pytest.mark.parametrize("arguments", [[], ["validate", "--help"], ["validate", "range-sensor", "--help"]])
def test_help_loads_neither_engine_nor_plots(arguments):
    program = (
        "import sys, pipeline, pipeline.cli; code = pipeline.cli.main(sys.argv[1:]) if sys.argv[1:] else 0; "
        "print(*sorted({name.partition('.')[0] for name in sys.modules}), file=sys.stderr); sys.exit(code)"
    )
    ended = subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=True)
    loaded = set(ended.stderr.split())
    assert "pipeline" in loaded
    assert loaded.isdisjoint({"pybullet", "bpy", "matplotlib", "scipy"})

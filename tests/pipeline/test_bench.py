"""`symolo bench`: what is written, what is said, and what is refused."""

import contextlib
import io
import json
import subprocess
import sys

import pytest

from pipeline.cli import main

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"


@pytest.fixture(scope="module")
def benches(tmp_path_factory):
    """Motor and line bench in one folder, as they may be: it is read only, and made once, for each takes seconds."""
    out = tmp_path_factory.mktemp("benches") / "out"
    with contextlib.redirect_stdout(io.StringIO()) as said:
        assert main(["bench", "motor", "--out", str(out)]) == 0
        assert main(["bench", "line", "--out", str(out), "--robot", "worn"]) == 0
    return out, said.getvalue()


def files_of(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


@pytest.mark.parametrize(
    ("bench", "robot", "says"),
    [("motor", "nominal", "breaks away at 160.2 mV"), ("line", "worn", "1024 levels of 1024")],
)
def test_a_bench_writes_json_and_picture(bench, robot, says, benches):
    out, said = benches
    assert says in said
    files = files_of(out)
    assert set(files) == {"motor.json", "motor.png", "line.json", "line.png"}
    assert files[f"{bench}.png"].startswith(PNG_SIGNATURE)
    told = json.loads(files[f"{bench}.json"])
    assert (told["bench"], told["seed"], told["robot"]["name"]) == (bench, 1, robot)


def test_a_bench_writes_the_same_bytes_each_time(benches, symolo, tmp_path):
    """The line bench, which alone of the two draws random numbers."""
    assert symolo("bench", "line", "--out", tmp_path / "out", "--robot", "worn").code == 0
    again, before = files_of(tmp_path / "out"), files_of(benches[0])
    assert again == {name: before[name] for name in ("line.json", "line.png")}


def test_the_motor_bench_tells_table_1_and_table_2(benches):
    steady = json.loads((benches[0] / "motor.json").read_text())["result"]["steady"]
    assert steady["voltage_V"][-1] == 5.0
    assert steady["table_2"]["parameters"] == {
        "winding_resistance_ohm": 3.03,
        "torque_constant_N_m_A": 0.31,
        "viscous_friction_N_m_s_rad": 0.002,
        "coulomb_friction_N_m": 0.02,
    }


def test_the_effects_of_the_robot_are_told(benches):
    told = json.loads((benches[0] / "line.json").read_text())
    assert told["robot"]["effects"]["winding_resistance_scale"] == {"scale": 1.08}


def test_the_range_bench_with_few_readings_leaves_the_tables_open(symolo, tmp_path, monkeypatch):
    monkeypatch.setattr("diagnosis.validation.range_sensor.recordings.static.MODEL_READINGS", 300)
    (tmp_path / "still").mkdir()
    record = "Fs,50.00\nLogging time,20\nd\n" + "100.0\n101.0\n99.0\n103.0\n" * 250
    (tmp_path / "still" / "record.csv").write_text(record)
    ended = symolo("bench", "tof", "--out", tmp_path / "out", "--readings", "10", "--static", tmp_path / "still")
    assert (ended.code, ended.err) == (0, "")
    lines = ended.out.splitlines()
    for table in ("Table 3", "Table 4"):
        assert any(line.startswith(f"open    {table}") for line in lines)
    # The 10-90 % width of a disc of even light is 0.69 of the footprint; a beam brighter in the middle has less.
    assert any(line.startswith("MISSED  step, 10-90 % width over the footprint") for line in lines)
    assert any(line.startswith("holds   field of view") for line in lines)
    assert any(line.startswith("real    record.csv: noise of a reading") for line in lines)
    files = files_of(tmp_path / "out")
    assert set(files) == {"tof.json", "tof.png", "tof_measured.json", "tof_measured.png"}
    assert files["tof.png"].startswith(PNG_SIGNATURE)
    assert files["tof_measured.png"].startswith(PNG_SIGNATURE)
    result = json.loads(files["tof.json"])["result"]
    surfaces = [row["surface"] for experiment in ("tones", "materials") for row in result[experiment]["table"]]
    assert len(surfaces) == 9
    assert [check["holds"] for check in result["checks"][:2]] == [None, None]
    assert len(result["step"]) == 6
    assert len(result["tilt"]) == 2 * 6
    assert len(result["field_of_view"]) == 6


BAD = {
    "no bench of that name": (["bench", "moter", "--out", "OUT"], "'motor'"),
    "no folder": (["bench", "motor"], "--out"),
    "misspelt robot": (["bench", "motor", "--out", "OUT", "--robot", "nominel"], "did you mean nominal"),
    "no such robot file": (["bench", "line", "--out", "OUT", "--robot", "nowhere.yaml"], "nowhere.yaml"),
    "robot without inertia": (["bench", "motor", "--out", "OUT", "--robot", "HERE/rotor.yaml"], "rotor_inertia_kg_m2"),
    "robot with a blind sensor": (["bench", "line", "--out", "OUT", "--robot", "HERE/blind.yaml"], "threshold"),
    "robot that sees nothing": (["bench", "tof", "--out", "OUT", "--robot", "HERE/near.yaml"], "no board at 100 mm"),
    "too few readings": (["bench", "tof", "--out", "OUT", "--readings", "9"], "--readings"),
    "no folder of scans": (["bench", "tof", "--out", "OUT", "--scan", "nowhere"], "--scan nowhere: no such folder"),
    "empty folder of scans": (["bench", "tof", "--out", "OUT", "--scan", "HERE/empty"], "holds no .csv file"),
    "folder of scans is a file": (["bench", "tof", "--out", "OUT", "--scan", "HERE/near.yaml"], "no such folder"),
    "no folder of records": (["bench", "tof", "--out", "OUT", "--static", "nowhere"], "--static nowhere"),
    "record cut off": (["bench", "tof", "--out", "OUT", "--static", "HERE/cut"], "row 1003: column d: got ''"),
    "seed below zero": (["bench", "line", "--out", "OUT", "--seed", "-1"], "--seed"),
    "folder of somebody else": (["bench", "motor", "--out", "HERE"], "did not make"),
    "folder is a file": (["bench", "motor", "--out", "HERE/blind.yaml"], "is a file"),
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
    arguments, say = BAD[kind]
    ended = symolo(*arguments)
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith("symolo: ")
    assert ended.err.count("\n") == 1
    assert say in ended.err
    assert sorted(tmp_path.rglob("*")) == before


def test_a_folder_of_benches_is_no_dataset(benches, symolo):
    ended = symolo("simulate", "smoke", "--out", benches[0])
    assert ended.code == 2
    assert "symolo bench" in ended.err


@pytest.mark.parametrize("arguments", [[], ["bench", "--help"], ["bench", "tof", "--help"]])
def test_help_loads_neither_engine_nor_plots(arguments):
    program = (
        "import sys, pipeline, pipeline.cli; code = pipeline.cli.main(sys.argv[1:]) if sys.argv[1:] else 0; "
        "print(*sorted({name.partition('.')[0] for name in sys.modules}), file=sys.stderr); sys.exit(code)"
    )
    ended = subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=True)
    loaded = set(ended.stderr.split())
    assert "pipeline" in loaded
    assert loaded.isdisjoint({"pybullet", "bpy", "matplotlib", "scipy"})

"""`symolo bench`: what is written, what is said, and what is refused."""

import json
import subprocess
import sys

import pytest

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"


@pytest.mark.parametrize(("bench", "says"), [("motor", "breaks away at 160.2 mV"), ("line", "1024 levels of 1024")])
def test_a_bench_writes_json_and_picture_the_same_each_time(bench, says, symolo, tmp_path):
    out = tmp_path / "out"
    ended = symolo("bench", bench, "--out", out)
    assert (ended.code, ended.err) == (0, "")
    assert says in ended.out
    files = {path.name: path.read_bytes() for path in out.iterdir() if path.is_file()}
    assert set(files) == {f"{bench}.json", f"{bench}.png"}
    assert files[f"{bench}.png"].startswith(PNG_SIGNATURE)
    told = json.loads(files[f"{bench}.json"])
    assert (told["bench"], told["seed"], told["robot"]["name"]) == (bench, 1, "nominal")
    assert symolo("bench", bench, "--out", out).code == 0
    assert {path.name: path.read_bytes() for path in out.iterdir() if path.is_file()} == files


def test_the_motor_bench_tells_table_1_and_table_2(symolo, tmp_path):
    assert symolo("bench", "motor", "--out", tmp_path / "out", "--robot", "worn").code == 0
    told = json.loads((tmp_path / "out" / "motor.json").read_text())
    steady = told["result"]["steady"]
    assert steady["voltage_V"][-1] == 5.0
    assert steady["table_2"]["parameters"] == {
        "winding_resistance_ohm": 3.03,
        "torque_constant_N_m_A": 0.31,
        "viscous_friction_N_m_s_rad": 0.002,
        "coulomb_friction_N_m": 0.02,
    }
    assert told["robot"]["terms"]["winding_resistance_scale"] == {"scale": 1.08}


BAD = {
    "no bench of that name": (["bench", "moter", "--out", "OUT"], "'motor'"),
    "no folder": (["bench", "motor"], "--out"),
    "misspelt robot": (["bench", "motor", "--out", "OUT", "--robot", "nominel"], "did you mean nominal"),
    "no such robot file": (["bench", "line", "--out", "OUT", "--robot", "nowhere.yaml"], "nowhere.yaml"),
    "robot without inertia": (["bench", "motor", "--out", "OUT", "--robot", "HERE/rotor.yaml"], "rotor_inertia_kg_m2"),
    "robot with a blind sensor": (["bench", "line", "--out", "OUT", "--robot", "HERE/blind.yaml"], "threshold"),
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
    before = sorted(tmp_path.rglob("*"))
    arguments, say = BAD[kind]
    ended = symolo(*arguments)
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith("symolo: ")
    assert ended.err.count("\n") == 1
    assert say in ended.err
    assert sorted(tmp_path.rglob("*")) == before


def test_a_folder_of_benches_is_no_dataset(symolo, tmp_path):
    assert symolo("bench", "line", "--out", tmp_path / "out").code == 0
    ended = symolo("simulate", "smoke", "--out", tmp_path / "out")
    assert ended.code == 2
    assert "symolo bench" in ended.err


@pytest.mark.parametrize("arguments", [[], ["bench", "--help"], ["bench", "motor", "--help"]])
def test_help_loads_neither_engine_nor_plots(arguments):
    program = (
        "import sys, pipeline, pipeline.cli; code = pipeline.cli.main(sys.argv[1:]) if sys.argv[1:] else 0; "
        "print(*sorted({name.partition('.')[0] for name in sys.modules}), file=sys.stderr); sys.exit(code)"
    )
    ended = subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=True)
    loaded = set(ended.stderr.split())
    assert "pipeline" in loaded
    assert loaded.isdisjoint({"pybullet", "bpy", "matplotlib", "scipy"})

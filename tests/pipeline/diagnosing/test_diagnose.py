"""`symolo diagnose`: what is written and printed, side by side and alone, and what is refused."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from configs.loader import load_scenario
from diagnosis.progress import Phase
from pipeline.diagnosing.diagnose import NamedCase, PhaseLines, cases_of
from pipeline.diagnosing.table import diagnosis_table
from pipeline.work.units import DiagnoseUnit, DiagnosisSettings, Progress
from pipeline.work.worker_main import diagnose_case, do
from sensors.registry import SENSORS
from symolo.core.errors import RunFailed
from tests.contracts.test_own_sensor import TOY


@pytest.fixture(scope="module")
def benches(motor_bench_case, tmp_path_factory):
    root = tmp_path_factory.mktemp("benches")
    motor_bench_case(root / "weak", strength=0.9)
    motor_bench_case(root / "plain")
    motor_bench_case(root / "broken")
    data = root / "broken" / "data.csv"
    data.write_text(data.read_text().replace("\n5,1,", "\n5,one,"))
    return root


def bytes_of(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and ".stages" not in path.parts
    }


def test_a_bad_case_is_named_and_the_other_one_is_finished_as_if_alone(symolo, benches, tmp_path, in_this_process):
    many, one = tmp_path / "many", tmp_path / "one"
    names = ("weak", "broken")
    ended = symolo("diagnose", *(benches / name for name in names), "--out", many, "--workers", 2)
    assert ended.code == 3
    assert "broken/data.csv: row 6: column sweep" in ended.err
    assert "Traceback" not in ended.err
    lines = ended.out.splitlines()
    assert [line.split()[0] for line in lines[1:3]] == ["weak", "broken"]
    assert "torque_constant_scale" in lines[1]
    assert lines[2].endswith("FAILED, see above")
    assert not (many / "broken").exists()

    # The law of an earlier diagnosis into the folder goes with its answer.
    (one / ".stages").mkdir(parents=True)
    (one / "answer.json").write_text('{"discovery": {"law": "range_old", "file": "range_old.py"}}')
    (one / "range_old.py").write_text("# a law")
    with in_this_process():
        alone = symolo("diagnose", benches / "weak", "--out", one, "--explain")
    assert alone.code == 0
    assert bytes_of(one) == bytes_of(many / "weak")
    files = bytes_of(one)
    assert files.keys() >= {"answer.json", "extended.yaml", "posterior.yaml", "report.html", "plots/gain.png"}
    assert alone.out.startswith(files["summary.txt"].decode())
    assert files["reasoning.txt"].decode() in alone.out


def test_a_case_alone_starts_no_worker_and_uses_one_thread(benches, tmp_path):
    program = (
        "import os, sys, pipeline.cli; started = []; "
        "sys.addaudithook(lambda event, of: started.append(of[0]) if event == 'subprocess.Popen' else None); "
        "code = pipeline.cli.main(sys.argv[1:]); "
        "print(os.environ['OPENBLAS_NUM_THREADS'], sys.executable in started, file=sys.stderr); sys.exit(code)"
    )
    command = [sys.executable, "-c", program, "diagnose", benches / "weak", "--out", tmp_path / "out", "--json"]
    several = os.environ | {"OPENBLAS_NUM_THREADS": "3"}
    ended = subprocess.run(command, capture_output=True, text=True, check=True, env=several)
    assert ended.stderr.splitlines()[-1] == "1 False"
    assert json.loads(ended.stdout)["effects"][0]["name"] == "torque_constant_scale"


@pytest.mark.usefixtures("hands")
def test_the_answers_are_printed_as_json_and_a_simulation_takes_the_robot(symolo, benches, tmp_path, tiny):
    """Of a robot with a sensor in a file of the user: the file is copied beside the robot that names it."""
    (tmp_path / "feeler.py").write_text(TOY)
    nominal = tmp_path / "feeling.yaml"
    nominal.write_text(
        "extends: nominal\nname: feeling\nsensor_files: [feeler.py]\nsensors: {feeler: {travel_m: 0.02}}\n"
    )
    out = tmp_path / "weak"
    try:
        ended = symolo("diagnose", benches / "weak" / "data.csv", "--out", out, "--json", "--nominal", nominal)
        assert ended.code == 0, ended.err
        assert json.loads(ended.out) == json.loads((out / "answer.json").read_bytes())
        assert (out / "feeler.py").read_text() == TOY
        robot = f"robot={out / 'extended.yaml'}"
        driven = symolo("simulate", "smoke", "--out", tmp_path / "driven", "--set", robot, *tiny, "--workers", "1")
        assert driven.code == 0, driven.err
    finally:
        for file in [*SENSORS.files.values()]:
            SENSORS.unload(file.path)


@pytest.mark.usefixtures("hands")
def test_cases_of_one_robot_have_one_answer_with_a_gain_for_each(symolo, benches, tmp_path):
    shutil.copytree(benches / "weak", tmp_path / "again")
    out = tmp_path / "both"
    ended = symolo("diagnose", benches / "weak", tmp_path / "again", "--together", "--out", out, "--json")
    assert ended.code == 0, ended.err
    answer = json.loads((out / "answer.json").read_bytes())
    assert json.loads(ended.out) == answer
    (effect,) = answer["effects"]
    assert effect["name"] == "torque_constant_scale"
    assert set(answer["cases"]) == {"weak", "again"}
    assert "weak+again" in (out / "summary.txt").read_text()
    load_scenario("smoke", [f"robot={out / 'extended.yaml'}"])


def test_the_table_has_laws(tmp_path):
    answers = {
        "named": {"effects": [{"name": "supply_sag"}], "unexplained": True, "discovery": {"law": "friction_bump"}},
        "none": {"effects": [], "unexplained": False, "discovery": {"law": None, "reason": "none is needed"}},
    }
    for name, answer in answers.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "answer.json").write_text(json.dumps(answer))
    lines = list(diagnosis_table([NamedCase(tmp_path / name, name) for name in answers], tmp_path, ()))
    assert lines[1].endswith("supply_sag, UNEXPLAINED, law friction_bump")
    assert lines[2].endswith("nothing")


BAD = {
    "nowhere": (["nowhere", "--out", "OUT"], "no such file or folder"),
    "no case": (["--out", "OUT"], "CASE"),
    "no folder": (["HERE/plain"], "--out"),
    "a broken case alone": (["HERE/broken", "--out", "OUT"], "data.csv: row 6: column sweep"),
    "two of one name": (["HERE/plain", "HERE/plain/data.csv", "--out", "OUT"], "another case has the name plain"),
    "no such importer": (["HERE/plain", "--importer", "motor_stedy", "--out", "OUT"], "did you mean motor_steady"),
    "no such robot": (["HERE/plain", "--nominal", "nomnal", "--out", "OUT"], "did you mean nominal"),
    "a robot that is drawn": (["HERE/plain", "--nominal", "fleet", "--out", "OUT"], "no distributions"),
    "output holds other files": (["HERE/plain", "--out", "HERE"], "did not make"),
    "a dataset against a bench": (["HERE/plain", "--against", "HERE/plain", "--out", "OUT"], "is no run of a dataset"),
    "no such trial to hold out": (["HERE/plain", "--hold-out", "cirle*", "--out", "OUT"], "got 'cirle*'"),
    "no such part": (["HERE/plain", "--part", "left wheel", "--out", "OUT"], "no trial is of that part"),
    "one case together": (["HERE/plain", "--together", "--out", "OUT"], "name two or more cases of the same robot"),
    "a bad case together": (["HERE/plain", "HERE/broken", "--together", "--out", "OUT"], "row 6: column sweep"),
    "runs of a dataset together": (
        ["DATASET/CW/test_1", "DATASET/CCW/test_1", "--together", "--out", "OUT"],
        "CW/test_1/data.csv: has no nominal.yaml, so it cannot be fitted together; name cases with a nominal.yaml; for",
    ),
    "both ways to print": (["HERE/plain", "--out", "OUT", "--json", "--explain"], "give one of them"),
}


@pytest.mark.parametrize("kind", BAD)
def test_bad_input_is_one_line_and_nothing_is_written(kind, symolo, benches, dataset, tmp_path):
    arguments, said = BAD[kind]
    places = {"HERE": benches, "OUT": tmp_path / "out", "DATASET": dataset}
    placed = [next((a.replace(word, str(at)) for word, at in places.items() if word in a), a) for a in arguments]
    ended = symolo("diagnose", *placed)
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith("symolo: ")
    assert ended.err.count("\n") == 1
    assert said in ended.err
    assert not (tmp_path / "out").exists()


def test_runs_of_one_number_have_the_names_of_their_routes():
    names = [case.name for case in cases_of([Path("data/CW/test_1"), Path("data/CCW/test_1"), Path("bench/data.csv")])]
    assert names == ["CW-test_1", "CCW-test_1", "bench"]


def unit(tmp_path, *, alone):
    return DiagnoseUnit(
        name="one",
        case=tmp_path / "case",
        settings=DiagnosisSettings(),
        folder=tmp_path / "out" / "one",
        alone=alone,
    )


def divides_by_zero(*_arguments, **_options):
    raise ZeroDivisionError("by nought")


def test_an_output_folder_of_the_cases_own_name_is_refused(symolo, tmp_path, monkeypatch):
    """Once it is there, `table-1` would be looked for in it."""
    monkeypatch.chdir(tmp_path)
    ended = symolo("diagnose", "table-1", "--out", "table-1")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert "--out table-1: is the name of a case" in ended.err
    assert list(tmp_path.iterdir()) == []


def test_a_bug_that_one_of_several_cases_brings_out_fails_that_case_alone(tmp_path, monkeypatch):
    monkeypatch.setattr("pipeline.diagnosing.diagnose.diagnose_into", divides_by_zero)
    with pytest.raises(RunFailed, match=r"a bug of symolo: ZeroDivisionError: by nought; please report it with .*"):
        diagnose_case(unit(tmp_path, alone=False), print)
    assert "ZeroDivisionError" in (tmp_path / "out" / "one" / "traceback.txt").read_text()
    with pytest.raises(ZeroDivisionError):
        diagnose_case(unit(tmp_path, alone=True), print)


def test_a_diagnosis_reports_a_share_that_grows(benches, tmp_path, monkeypatch):
    monkeypatch.setattr("pipeline.work.worker_main.SECONDS_BETWEEN_SHARES", 0.0)
    shares: list[float] = []
    texts: list[str] = []

    def on_progress(share: float, at: int | None = None, text: str = "") -> None:  # noqa: ARG001 - of frames
        shares.append(share)
        texts.append(text)

    diagnose_case(unit(tmp_path, alone=True).model_copy(update={"case": benches / "plain"}), on_progress)
    assert len(shares) > len(Phase)
    assert shares == sorted(shares)
    assert Phase.PLOTS.value / 100 <= shares[-1] < 1.0
    assert any("models are still being fitted (" in text for text in texts)


def test_phases_after_the_selection_state_the_time_left_of_a_long_diagnosis(monkeypatch):
    """The selection is 45 % of the time: after 90 s, 110 s are left; at 85 % after 170 s, 30 s are."""
    clock, lines = [0.0], []
    monkeypatch.setattr("pipeline.diagnosing.diagnose.time.monotonic", lambda: clock[0])
    stage = SimpleNamespace(say=lines.append)
    for speed, estimates in ((1.0, True), (0.01, True), (1.0, False)):
        clock[0] = 0.0
        phases = PhaseLines(stage, estimates=estimates)
        for phase, at_s in ((Phase.SELECTION, 1.0), (Phase.STRUCTURE, 90.0), (Phase.PLOTS, 170.0)):
            clock[0] = speed * at_s
            phases.print(Progress(share=phase.value / 100))
    titles = [phase.title for phase in (Phase.SELECTION, Phase.STRUCTURE, Phase.PLOTS)]
    assert lines[:3] == [titles[0], f"{titles[1]}; about 1 min 50 s left", f"{titles[2]}; about 30.0 s left"]
    assert lines[3:6] == lines[6:] == titles


def test_too_little_memory_for_one_of_several_cases_is_no_bug(tmp_path, monkeypatch):
    def lacks_memory(*_arguments, **_options):
        raise MemoryError

    monkeypatch.setattr("pipeline.diagnosing.diagnose.diagnose_into", lacks_memory)
    failed = do(unit(tmp_path, alone=False), print)
    assert (failed.error, "there is not enough memory" in failed.text) == ("environment", True)
    assert not (tmp_path / "out").exists()

"""The exam of bare logs: which logs it makes, and which results of an earlier run it uses again."""

import json
from dataclasses import asdict
from importlib import import_module
from pathlib import Path

import pytest


@pytest.fixture
def exam(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).parents[2] / "benchmarks" / "diagnosis" / "exams"))
    return import_module("log_exam")


@pytest.mark.parametrize("names", [("tof_mount_yaw",), ("line_gain", "none"), ("a", "b", "c"), tuple("abcdef")])
def test_every_name_is_hidden_in_every_arena(exam, names):
    scenarios = {}
    for plan in exam.plans(3 * len(names), 1, names):
        scenarios.setdefault(plan.name.partition("_")[2], []).append(plan.scenario)
    assert {name: sorted(each) for name, each in scenarios.items()} == {n: sorted(exam.SCENARIOS) for n in names}


def test_effects_of_line_sensor_and_camera_are_hidden_too(exam):
    hidden = {plan.hidden.name for plan in exam.plans(len(exam.TURNS), 1)}
    assert {"marker_yaw", "line_gain", "line_offset", "line_height", "line_ambient"} <= hidden
    assert {"line_adc_saturation", "line_lateral_offset", "line_crosstalk", ""} <= hidden


def results(plans, **more):
    return "".join(json.dumps({"plan": asdict(plan), "case": plan.name, **more}) + "\n" for plan in plans)


def test_a_stopped_run_goes_on_with_the_logs_that_are_missing_or_failed(exam, tmp_path):
    asked = exam.plans(6, 1)
    (tmp_path / "logs.jsonl").write_text(results(asked[:2]) + results(asked[2:4], failed="no memory"))
    done, todo = exam.resumed(tmp_path / "logs.jsonl", asked)
    assert [each["case"] for each in done] == [plan.name for plan in asked[:2]]
    assert todo == asked[2:]


def test_results_of_another_seed_or_of_more_logs_are_not_counted(exam, tmp_path):
    (tmp_path / "logs.jsonl").write_text(results(exam.plans(6, 1)))
    assert exam.resumed(tmp_path / "logs.jsonl", exam.plans(6, 2)) == ([], exam.plans(6, 2))
    assert len(exam.resumed(tmp_path / "logs.jsonl", exam.plans(3, 1))[0]) == 3


def test_an_unknown_name_is_refused(exam, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["log_exam.py", "--names", "tof_mount_jaw", "--out", str(tmp_path / "out")])
    with pytest.raises(SystemExit) as ended:
        exam.main()
    assert ended.value.code == 2
    assert "tof_mount_jaw" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()

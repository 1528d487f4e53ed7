"""The evaluation of bare logs: which logs it makes, and which results of an earlier run it uses again."""

import json
from dataclasses import asdict
from importlib import import_module
from pathlib import Path

import pytest


@pytest.fixture
def evaluation(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).parents[2] / "benchmarks" / "diagnosis" / "evaluations"))
    return import_module("bare_logs")


@pytest.mark.parametrize("names", [("tof_mount_yaw",), ("line_gain", "none"), ("a", "b", "c"), tuple("abcdef")])
def test_every_name_is_hidden_in_every_arena(evaluation, names):
    scenarios = {}
    for plan in evaluation.plans(3 * len(names), 1, names):
        scenarios.setdefault(plan.name.partition("_")[2], []).append(plan.scenario)
    assert {name: sorted(each) for name, each in scenarios.items()} == {n: sorted(evaluation.SCENARIOS) for n in names}


def test_effects_of_line_sensor_and_camera_are_hidden_too(evaluation):
    hidden = {plan.hidden.name for plan in evaluation.plans(len(evaluation.TURNS), 1)}
    assert {"marker_yaw", "line_gain", "line_offset", "line_height", "line_ambient"} <= hidden
    assert {"line_adc_saturation", "line_lateral_offset", "line_crosstalk", ""} <= hidden


def results(plans, **more):
    return "".join(json.dumps({"plan": asdict(plan), "case": plan.name, **more}) + "\n" for plan in plans)


def test_a_stopped_run_goes_on_with_the_logs_that_are_missing_or_failed(evaluation, tmp_path):
    asked = evaluation.plans(6, 1)
    (tmp_path / "logs.jsonl").write_text(results(asked[:2]) + results(asked[2:4], failed="no memory"))
    done, todo = evaluation.resumed(tmp_path / "logs.jsonl", asked)
    assert [each["case"] for each in done] == [plan.name for plan in asked[:2]]
    assert todo == asked[2:]


def test_results_of_another_seed_or_of_more_logs_are_not_counted(evaluation, tmp_path):
    (tmp_path / "logs.jsonl").write_text(results(evaluation.plans(6, 1)))
    assert evaluation.resumed(tmp_path / "logs.jsonl", evaluation.plans(6, 2)) == ([], evaluation.plans(6, 2))
    assert len(evaluation.resumed(tmp_path / "logs.jsonl", evaluation.plans(3, 1))[0]) == 3


def test_an_unknown_name_is_refused(evaluation, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["bare_logs.py", "--names", "tof_mount_jaw", "--out", str(tmp_path / "out")])
    with pytest.raises(SystemExit) as ended:
        evaluation.main()
    assert ended.value.code == 2
    assert "tof_mount_jaw" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()

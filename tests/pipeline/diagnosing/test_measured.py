"""`symolo inspect`: what is said of measured data, and what is refused."""

import json
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from diagnosis.examples.example import FOLDER as EXAMPLES
from diagnosis.importers.choose import read_measurement
from diagnosis.measured.channel import SampleQuality
from diagnosis.measured.measurement import CaseKind
from diagnosis.measured.predicted_kinds import PREDICTED_KINDS
from diagnosis.predictors import STAGES
from pipeline.diagnosing.importers import IMPORTERS
from pipeline.diagnosing.importers.data_csv import no_target_code_m
from symolo.dataset.tables.rows import read_rows


def read(path):
    return read_measurement(path, IMPORTERS)


def test_the_paper_s_table_is_reported(symolo):
    ended = symolo("inspect", "table-1")
    assert (ended.code, ended.err) == (0, "")
    assert ended.out.startswith("table-1: motor_steady, 1 trial, 21 rows (none held out)\n")
    assert re.search(r"^omega_rad_s +rad/s +reading +21 .* 0 +14.32 ", ended.out, re.MULTILINE)


def test_a_run_of_our_own_is_read_with_voltages_and_counts(dataset):
    run = dataset / "CW" / "test_1"
    (trial,) = read(run).trials
    rows = read_rows(run / "data.csv")
    wheels = np.genfromtxt(run / "side" / "wheels.csv", delimiter=",", names=True)
    assert trial.name == "CW/test_1"
    np.testing.assert_array_equal(trial["x_m"].values, rows.pose[:, 0])
    np.testing.assert_array_equal(trial["u_left_V"].values, [*wheels["mean_voltage_l"][1:], np.nan])
    np.testing.assert_array_equal(trial["enc_right_ticks"].values, wheels["counts_r"])
    no_target = trial["tof_left_m"].quality == SampleQuality.NO_TARGET
    np.testing.assert_array_equal(no_target, rows.tof_m[:, 1] == 2.0)
    assert no_target.any()
    assert {channel.clock for channel in trial.channels} == {"log"}


def test_a_table_of_a_run_of_our_own_becomes_no_case(dataset, symolo, tmp_path):
    run = dataset / "CW" / "test_1"
    for table in (run / "data.csv", run / "side" / "wheels.csv"):
        ended = symolo("case", "init", table, "--out", tmp_path / "case")
        assert (ended.code, ended.out) == (2, "")
        assert f"diagnose the run: symolo diagnose {run} --out test_1-diagnosis" in ended.err
    assert not (tmp_path / "case").exists()


def test_a_table_that_was_copied_out_of_its_run_is_no_run(dataset, symolo, tmp_path):
    """The folder beside it has no data.csv, so that a diagnosis of it would only be refused again."""
    table = tmp_path / "side" / "wheels.csv"
    table.parent.mkdir()
    shutil.copy(dataset / "CW" / "test_1" / "side" / "wheels.csv", table)
    ended = symolo("case", "init", table, "--out", tmp_path / "case")
    assert (ended.code, ended.out) == (2, "")
    assert "diagnose the folder of the run from which it was copied, the one with data.csv" in ended.err
    assert str(tmp_path) not in ended.err.replace(str(table), "")


def test_the_stages_predict_runs_of_our_own_from_voltages_and_counts(dataset):
    """To a few counts: a count in a row is 2 pi / 3840 / 0.05 s = 0.033 rad/s, and 0.05 mm of way."""
    robot = draw_robot(load_section("robot", "nominal"), 1, "test")[0]
    wheels, pose, ranges = STAGES[CaseKind.DRIVE_LOG](read(dataset), robot)
    for of, predicted in zip(wheels.observed, wheels.predict([robot]), strict=True):
        off = np.abs(of.values - predicted.mean[0])[of.usable]
        assert len(off) == 40
        assert np.median(off) < 0.033
        assert off.max() < 3 * 0.033
    for of, predicted, bound in zip(pose.observed, pose.predict([robot]), (2e-4, 2e-4, 1e-3), strict=True):
        assert np.abs(of.values - predicted.mean[0])[of.usable].max() < bound
    z = [
        ((of.values - predicted.mean[0]) / predicted.sd[0])[of.usable]
        for of, predicted in zip(ranges.observed, ranges.predict([robot]), strict=True)
    ]
    assert np.abs(np.concatenate(z)).max() < 4.0
    assert 0.7 < np.concatenate(z).std() < 1.2


def test_without_its_specification_a_run_has_no_arena_and_its_ranges_are_not_compared(copy_of, dataset):
    root = copy_of(dataset)
    assert [trial.arena.name for trial in read(root).trials] == ["symolo", "symolo"]
    (root / "CW" / "test_1" / "side" / "spec.json").unlink()
    measurement = read(root)
    assert measurement.notes[-1] == "ranges are not compared: no spec.json, which states the arena, in CW/test_1"
    robot = draw_robot(load_section("robot", "nominal"), 1, "test")[0]
    assert [stage.name for stage in STAGES[CaseKind.DRIVE_LOG](measurement, robot)] == ["wheels", "pose"]


def test_ranges_of_a_run_that_was_rendered_again_are_not_compared_with_the_arena_of_its_images(copy_of, dataset):
    root = copy_of(dataset)
    path = root / "CW" / "test_1" / "side" / "spec.json"
    origin = {"release": {"name": "smoke", "manifest_sha256": "", "run": "CW/test_1"}}
    path.write_text(json.dumps({**json.loads(path.read_text()), "origin": origin}))
    measurement = read(root)
    assert [trial.arena is None for trial in measurement.trials] == [False, True]
    assert measurement.notes[-1].startswith("ranges are not compared: CW/test_1 was rendered again")


def test_voltages_between_rows_have_the_mean_and_the_last_value_of_each_row(dataset):
    run = dataset / "CW" / "test_1"
    (trial,) = read(run).trials
    wheels = np.genfromtxt(run / "side" / "wheels.csv", delimiter=",", names=True)
    for series, side in zip(trial.held_inputs, "lr", strict=True):
        between = series.values.reshape(20, 5)  # the wheel loop runs at 100 Hz, and there are 20 rows per second
        np.testing.assert_allclose(between.mean(axis=1), wheels[f"mean_voltage_{side}"][1:], atol=1e-9)
        np.testing.assert_allclose(between[:, -1], wheels[f"voltage_{side}"][1:], atol=1e-9)
        np.testing.assert_allclose(series.t_s, np.arange(100) / 100, atol=1e-9)


def test_a_release_is_all_of_its_runs(dataset):
    assert [trial.name for trial in read(dataset).trials] == ["CCW/test_1", "CW/test_1"]


def test_what_simulate_made_is_read_as_its_release(dataset):
    (released,) = read(dataset / "CW" / "test_1").trials
    (simulated,) = read(dataset / ".stages" / "simulate" / "CW" / "test_1").trials
    assert simulated.name == released.name
    np.testing.assert_array_equal(simulated.holdout, released.holdout)
    for ours, theirs in zip(simulated.channels, released.channels, strict=True):
        np.testing.assert_array_equal(ours.values, theirs.values, err_msg=ours.name)
        np.testing.assert_array_equal(ours.quality, theirs.quality, err_msg=ours.name)


def test_the_last_quarter_of_each_of_few_runs_is_held_out(dataset):
    for trial in read(dataset).trials:
        np.testing.assert_array_equal(trial.holdout, np.arange(21) >= 16)


def test_a_data_csv_alone_has_pose_and_ranges_but_no_voltages(dataset, tmp_path):
    path = tmp_path / "log.csv"
    path.write_bytes((dataset / "CW" / "test_1" / "data.csv").read_bytes())
    measurement = read(path)
    assert any("voltages, encoder counts" in note for note in measurement.notes)
    assert any("2 m, comes" in note for note in measurement.notes)
    (alone,), (run,) = measurement.trials, read(dataset / "CW" / "test_1").trials
    np.testing.assert_array_equal(alone["tof_left_m"].quality, run["tof_left_m"].quality)
    np.testing.assert_array_equal(alone["theta_rad"].values, run["theta_rad"].values)


@pytest.mark.parametrize(
    ("ranges_m", "code_m"),
    [
        ([0.41, 0.52, 0.6, 0.6, 0.6], None),  # a small arena: no sensor ends at 0.6 m
        ([1.31, 1.33, 1.35, 1.35, 1.35], None),  # a wall that is seen from there as from nearer
        ([0.41, 0.52, 1.2, 1.2, 1.2], 1.2),
        ([0.41, 0.52, 0.6, 2.0, 2.0], None),
    ],
)
def test_the_largest_range_means_no_target_only_far_off_and_by_itself(ranges_m, code_m):
    assert no_target_code_m(np.array([ranges_m])) == code_m


def test_side_tables_of_another_run_are_refused(copy_of, dataset, symolo):
    root = copy_of(dataset)
    wheels = root / "CW" / "test_1" / "side" / "wheels.csv"
    lines = wheels.read_text().splitlines()
    wheels.write_text("\n".join(lines[:-1]) + "\n")
    ended = symolo("inspect", root)
    assert ended.code == 2
    assert "wheels.csv: column t is not that of data.csv" in ended.err


BAD = {
    "nowhere": (["nowhere"], "no such file or folder"),
    "nothing known": (["."], "is not measured data of a known form"),
    "no such importer": (["table-1", "--importer", "papre"], "did you mean paper"),
    "wrong importer": (["table-1", "--importer", "motor_step"], "there is no nominal.yaml"),
    "a picture": (["picture.png"], "is not measured data"),
    "an empty file": (["empty.csv"], "empty.csv: is empty; record it again"),
}


@pytest.mark.parametrize("kind", BAD)
def test_bad_input_is_one_line(kind, symolo, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty.csv").touch()
    (tmp_path / "picture.png").write_bytes(b"\x89PNG\r\n\x1a\n\x00\x00\xff\xfe")
    arguments, said = BAD[kind]
    ended = symolo("inspect", *arguments)
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith("symolo: ")
    assert ended.err.count("\n") == 1
    assert said in ended.err


def test_help_loads_neither_engine_nor_numbers():
    program = (
        "import sys, pipeline.cli; code = pipeline.cli.main(['inspect', '--help']); "
        "print(*sorted({name.partition('.')[0] for name in sys.modules}), file=sys.stderr); sys.exit(code)"
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert "nominal.yaml" in ended.stdout
    assert set(ended.stderr.split()).isdisjoint({"pybullet", "bpy", "matplotlib", "scipy"})


def test_a_case_is_read_without_plots_images_and_fits():
    case = EXAMPLES / "motor_step_001"
    program = (
        f"import sys, pipeline.cli; code = pipeline.cli.main(['inspect', {str(case)!r}]); "
        "print(*sorted({name.partition('.')[0] for name in sys.modules}), file=sys.stderr); sys.exit(code)"
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert "u_cmd_V" in ended.stdout
    assert set(ended.stderr.split()).isdisjoint({"pybullet", "bpy", "cv2", "matplotlib", "scipy"})


def test_the_kinds_that_a_command_takes_without_loading_the_stages_are_those_with_stages():
    assert tuple(STAGES) == PREDICTED_KINDS


def test_a_diagnosis_loads_only_the_parts_of_scipy_that_every_diagnosis_needs():
    program = (
        "import sys, pipeline.work.worker_main, pipeline.diagnosing.diagnose, diagnosis.diagnose, "
        "diagnosis.report.files; print(*sys.modules)"
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    loaded = set(ended.stdout.split())
    assert "scipy.special" in loaded
    assert loaded.isdisjoint({"cv2", "scipy.optimize", "scipy.stats", "scipy.signal", "blender_scenes.scene.run_scene"})

"""Own estimates beside the baselines: which file belongs to which run, the table, and what is refused."""

import errno
import json
import shutil
from pathlib import Path

import numpy as np
import pytest

import symolo as reader
from pipeline.baselines.own_estimates import OwnEstimates, own_estimates
from symolo import InputError

RUNS = ["CCW/test_1", "CW/test_1"]


def tum(path, t_s, pose):
    """Write poses as TUM, without the code that reads them."""
    lines = [
        f"{t:.3f} {x:.6f} {y:.6f} 0 0 0 {np.sin(yaw / 2):.9f} {np.cos(yaw / 2):.9f}"
        for t, (x, y, yaw) in zip(t_s, pose, strict=True)
    ]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(lines) + "\n")


@pytest.fixture
def mine(dataset, tmp_path):
    """Estimates of every second row, 30 mm beside the true ones, of both runs."""
    for run in reader.load(dataset):
        tum(tmp_path / f"mine/{run.name}.txt", run.t_s[::2], run.table.pose[::2] + np.array([0.0, 0.03, 0.0]))
    return tmp_path / "mine"


def test_own_estimates_are_rows_of_the_same_table(symolo, dataset, mine, tmp_path):
    out = tmp_path / "out"
    ended = symolo("baselines", dataset, "--out", out, "--methods", "odometry", "--estimate", f"mine={mine}")
    assert ended.code == 0, ended.err
    for run in (*RUNS, "median"):
        (row,) = [line for line in ended.out.splitlines() if line.startswith(f"| {run} | mine | ")]
        cells = [cell.strip() for cell in row.strip("|").split("|")]
        assert cells[2:8] == ["30.0", "30.0", "30.0", "30.0", "0.00", "0.00"]
        assert cells[-3:] == ["-", "-", "100"]
        assert f"| {run} | odometry | " in ended.out
    assert "The estimates of mine are compared with the row of data.csv nearest in time, at most 10 ms" in ended.out
    assert "They are not aligned." in ended.out
    assert "one second to half a millisecond, which no two estimates every 150 ms are" in " ".join(ended.out.split())
    numbers = json.loads((out / "baselines.json").read_text())
    assert numbers["runs"]["CW/test_1"]["mine"]["ate_m"] == pytest.approx(0.03, abs=1e-6)
    assert numbers["runs"]["CW/test_1"]["mine"]["nees"] is None
    assert (out / "estimates/CW/test_1/mine.csv").read_text().startswith("t,x,y,theta\n0,")


def test_the_estimates_of_a_method_judged_as_own_ones_have_its_errors(symolo, dataset, tmp_path):
    first, second = tmp_path / "first", tmp_path / "second"
    assert symolo("baselines", dataset, "--out", first, "--methods", "odometry").code == 0
    for run in RUNS:
        shutil.copy(first / f"estimates/{run}/odometry.csv", first / f"estimates/{run}/copy.csv")
    option = f"copy={first / 'estimates'}"
    ended = symolo("baselines", dataset, "--out", second, "--methods", "none", "--estimate", option)
    assert ended.code == 0, ended.err
    assert "start pose of the robot" not in ended.out
    before, after = (json.loads((out / "baselines.json").read_text())["runs"] for out in (first, second))
    for run in RUNS:
        for name, value in before[run]["odometry"].items():
            expected = None if value is None else pytest.approx(value, rel=1e-3, abs=2e-6)
            assert after[run]["copy"][name] == expected, name


def test_imported_runs_are_judged_without_methods(symolo, dataset, tmp_path):
    run = reader.load(dataset)["CW/test_1"]
    tum(tmp_path / "log.txt", run.t_s, run.table.pose)
    assert symolo("import", tmp_path / "log.txt", "--out", tmp_path / "imported", "--yes").code == 0
    tum(tmp_path / "mine.tum", run.t_s, run.table.pose + np.array([0.01, 0.0, 0.0]))
    option = f"mine={tmp_path / 'mine.tum'}"
    ended = symolo("baselines", tmp_path / "imported", "--out", tmp_path / "out", "--estimate", option)
    assert ended.code == 0, ended.err
    assert "| imported/test_1 | mine | 10.0 |" in ended.out
    assert "- odometry: left out, the runs were imported" in ended.out
    refused = symolo("baselines", tmp_path / "imported", "--out", tmp_path / "other", "--methods", "ekf")
    assert refused.code == 2
    assert "imports are not supported" in refused.err


def test_another_frame_is_a_warning_that_an_alignment_cures(symolo, dataset, tmp_path):
    for run in reader.load(dataset):
        tum(tmp_path / f"mine/{run.name}.txt", run.t_s, run.table.pose + np.array([2.0, 0.0, 0.0]))
    arguments = ("baselines", dataset, "--methods", "none", "--estimate", f"mine={tmp_path / 'mine'}", "--out")
    ended = symolo(*arguments, tmp_path / "plain")
    assert "warning: mine, CW/test_1: ATE would be 0.000 m in place of 2.000 m after a turn of 0.0 deg" in ended.err
    assert "**Warning:** mine, CW/test_1: ATE would be" in ended.out
    aligned = symolo(*arguments, tmp_path / "aligned", "--align", "se2")
    assert "warning" not in aligned.err
    assert "| CW/test_1 | mine | 0.0 |" in aligned.out
    assert "aligned with the true ones by one turn and one shift for each run" in aligned.out


def test_faults_of_all_files_are_refused_together_before_anything_is_written(symolo, dataset, mine, tmp_path):
    for run in RUNS:
        path = mine / f"{run}.txt"
        path.write_text("".join(f"1{line}\n" for line in path.read_text().splitlines()))  # tens of seconds later
    ended = symolo("baselines", dataset, "--out", tmp_path / "out", "--estimate", f"mine={mine}")
    assert ended.code == 2
    assert "2 faults" in ended.err
    for run in RUNS:
        assert f"{run}.txt: the times" in ended.err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("mine", "allowed: NAME=FILE or NAME=FOLDER"),
        ("ekf=.", "the name ekf is used already"),
        ("mine=absent", "there is no such file or folder"),
        ("a b=.", "letters, digits"),
        (f"mine={'a' * 300}", "--estimate: cannot be used: File name too long"),
    ],
)
def test_options_that_name_nothing_are_refused(text, message):
    with pytest.raises(InputError) as refused:
        own_estimates([text], ["ekf"])
    assert message in str(refused.value)
    with pytest.raises(InputError, match="used already"):
        own_estimates(["mine=.", "mine=."], [])


def test_no_methods_and_no_estimates_are_refused(symolo, dataset, tmp_path):
    ended = symolo("baselines", dataset, "--out", tmp_path / "out", "--methods", "none")
    assert ended.code == 2
    assert "judge your own with --estimate" in ended.err


def test_the_file_of_a_run_may_have_three_places(tmp_path):
    estimates = OwnEstimates("mine", "mine", "", tmp_path)
    for place in ("CW/test_1.csv", "CW_test_1.tum", "CW/test_1/mine.txt"):
        path = tmp_path / place
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("")
        assert estimates.files(["CW/test_1"]) == {"CW/test_1": path}
        path.unlink()


def test_missing_and_surplus_files_are_refused(tmp_path):
    (tmp_path / "CW").mkdir()
    for name in ("test_1.csv", "test_2.txt", "test2.csv"):
        (tmp_path / "CW" / name).write_text("")
    estimates = OwnEstimates("mine", "mine", "", tmp_path)
    with pytest.raises(InputError) as refused:
        estimates.files(["CW/test_1", "CW/test_3", "CW/test_4"])
    assert "has no file for CW/test_3, CW/test_4" in str(refused.value)
    assert "name it CW/test_3.csv or CW/test_3.txt, or choose other runs with --runs" in str(refused.value)
    (tmp_path / "CW/test_1.txt").write_text("")
    with pytest.raises(InputError, match="are both for the run CW/test_1; keep one of them"):
        estimates.files(["CW/test_1"])
    file = OwnEstimates("mine", "mine", "", tmp_path / "CW/test_1.csv")
    assert file.files(["CW/test_9"]) == {"CW/test_9": tmp_path / "CW/test_1.csv"}
    with pytest.raises(InputError, match="is one file for 2 runs"):
        file.files(RUNS)


def test_a_hint_names_a_file_where_those_of_runs_are_and_does_not_search_everything(tmp_path, monkeypatch):
    estimates = OwnEstimates("mine", "mine", "", tmp_path)
    for place, is_hinted in (("a/b/CW/test_3.csv", False), ("CW/test3.csv", True)):
        path = tmp_path / place
        path.parent.mkdir(parents=True)
        path.write_text("")
        with pytest.raises(InputError, match="has no file for CW/test_3") as refused:
            estimates.files(["CW/test_3"])
        assert (f"{place} is there" in str(refused.value)) == is_hinted

    def many(folder, _):
        for i in range(20_000):
            assert i < 10_000, "a hint is not worth so many names"
            yield folder / f"{i}.csv"

    monkeypatch.setattr(Path, "glob", many)
    monkeypatch.setattr(Path, "rglob", many)
    with pytest.raises(InputError, match="has no file for CW/test_3"):
        estimates.files(["CW/test_3"])


def test_a_folder_that_cannot_be_read_is_refused_with_its_path(tmp_path, monkeypatch):
    def refuse(path):
        raise PermissionError(errno.EACCES, "Permission denied", str(path))

    monkeypatch.setattr(Path, "is_file", refuse)
    with pytest.raises(InputError, match=f"--estimate {tmp_path}: cannot be read: Permission denied"):
        OwnEstimates("mine", "mine", "", tmp_path).files(["CW/test_1"])

"""The command on a release: what it leaves, that it leaves the same again, and what it refuses."""

import json

import numpy as np
import pytest

import symolo as reader
from pipeline.baselines import odometry, retrieval
from pipeline.baselines.compare import compare, why_not
from pipeline.baselines.output import table
from pipeline.baselines.runs import open_runs
from pipeline.cli import main
from symolo.core.progress import LineReport

EXACT = np.full(3, 0.001)
METHODS = ["odometry", "ekf", "particles", "retrieval"]


@pytest.fixture(scope="module")
def files(dataset, tmp_path_factory):
    """Of two runs of the command."""
    made = []
    for name in ("one", "two"):
        out = tmp_path_factory.mktemp("made") / name
        assert main(["baselines", str(dataset), "--out", str(out), "--runs", "CW/*", "--start-sd-cm", "2"]) == 0
        made.append({path.relative_to(out).as_posix(): path.read_bytes() for path in out.rglob("*") if path.is_file()})
    return made


def test_the_same_release_gives_the_same_bytes(files):
    assert files[0] == files[1]


def test_it_leaves_a_table_numbers_a_figure_and_every_estimate(files):
    estimates = {f"estimates/CW/test_1/{name}.csv" for name in METHODS}
    assert files[0].keys() == {"baselines.md", "baselines.json", "baselines.png"} | estimates
    assert files[0]["baselines.png"].startswith(b"\x89PNG")


def test_the_numbers_are_those_of_the_estimates(files, dataset):
    data = reader.load(dataset)
    results = json.loads(files[0]["baselines.json"])
    assert results["start_sd"]["x_m"] == pytest.approx(0.02)
    assert list(results["runs"]) == ["CW/test_1"]
    for run, methods in results["runs"].items():
        assert list(methods) == sorted(METHODS)
        for name, errors in methods.items():
            lines = files[0][f"estimates/{run}/{name}.csv"].decode().splitlines()
            table = np.array([line.split(",") for line in lines[1:]], dtype=float)
            rows = data[run].rows.set_index("t").loc[table[:, 0]]
            off_m = np.hypot(table[:, 1] - rows["x"], table[:, 2] - rows["y"])
            assert errors["ate_m"] == pytest.approx(np.sqrt(np.mean(off_m**2)), abs=2e-6)
            assert f"| {run} | {name} | {1e3 * errors['ate_m']:.1f} |" in files[0]["baselines.md"].decode()


@pytest.mark.usefixtures("hands")
def test_without_rendered_images_that_method_is_left_out_with_the_reason(symolo, tiny, tmp_path):
    assert symolo("simulate", "smoke", "--out", tmp_path / "driven", *tiny).code == 0
    ended = symolo("baselines", tmp_path / "driven", "--out", tmp_path / "out", "--methods", "odometry,ekf")
    assert ended.code == 0
    assert "| CCW/test_1 | odometry |" in ended.out
    assert "| median | ekf |" in ended.out
    refused = symolo("baselines", tmp_path / "driven", "--out", tmp_path / "other", "--methods", "retrieval")
    assert refused.code == 2
    assert "no images" in refused.err
    assert not (tmp_path / "other").exists()


def test_a_release_of_one_run_has_nothing_to_learn_from(dataset):
    first = open_runs(dataset)[0]
    assert "one run only" in why_not(retrieval.METHOD, [first])
    assert not why_not(odometry.METHOD, [first])
    printed = table(
        compare([odometry.METHOD, retrieval.METHOD], [first], [first], start_sd=EXACT, seed=1, report=LineReport())
    )
    assert "- retrieval: left out, there is one run only" in printed
    assert "| CW/test_1 | odometry |" in printed
    assert not why_not(retrieval.METHOD, [first, first])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--methods", "efk"], "did you mean ekf"),
        (["--runs", "CW/test_9"], "CW/test_1"),
        (["--start-sd-cm", "0"], "start-sd-cm"),
    ],
)
def test_what_is_not_there_is_refused_before_anything_is_written(symolo, dataset, tmp_path, arguments, message):
    ended = symolo("baselines", dataset, "--out", tmp_path / "out", *arguments)
    assert ended.code == 2
    assert message in ended.err
    assert not (tmp_path / "out").exists()


def test_a_place_that_is_taken_and_a_damaged_release_are_refused(symolo, dataset, copy_of, tmp_path):
    assert "is there already" in symolo("baselines", dataset, "--out", dataset).err
    damaged = copy_of(dataset)
    path = damaged / "CW/test_1/data.csv"
    path.write_bytes(path.read_bytes().replace(b"0", b"1", 1))
    ended = symolo("baselines", damaged, "--out", tmp_path / "out")
    assert ended.code == 2
    assert "data.csv" in ended.err

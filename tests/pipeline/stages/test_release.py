"""A release is the same bytes however it is made, and a rerun does only what changed."""

import contextlib
import json
import math
import os
import platform
import shutil
import signal
import subprocess
import time
from pathlib import Path

import cv2
import pytest

from pipeline.run_folder.workspace import Workspace, input_key
from pipeline.work.processors import class_of
from symolo.core.files.atomic_files import remove_folder
from symolo.core.versions import versions
from tests.release_fixtures import ONE_ROUTE

ARENA_WITH_A_SILL = """
extends: symolo
name: with_a_sill
walls:
  - {name: A1, start: [-0.05, 0.90], end: [-0.85, 0.90]}
  - {name: sill, start: [0.65, -0.05], end: [0.45, -0.05], height_m: 0.03}
"""

ENDED = (FileNotFoundError, ProcessLookupError)
"""What /proc raises for a process or thread that has just ended."""


def test_columns_and_folders_are_those_of_the_paper(dataset):
    header = "t,x,y,theta,state,v,w,d_f,d_l,d_r,L0,L1,L2,L3,L4,L5,L6,L7,img"
    for route in ("CW", "CCW"):
        run = dataset / route / "test_1"
        lines = (run / "data.csv").read_text().splitlines()
        assert lines[0] == header
        assert [line.split(",")[0] for line in lines[1:]] == [str(50 * i) for i in range(21)]
        assert [line.split(",")[-1] for line in lines[1:6]] == ["1", "0", "0", "0", "2"]
        assert (run / "image_positions.txt").read_text().splitlines()[0] == "img x y theta"
        assert sorted(p.name for p in (run / "images").iterdir()) == [f"{i:06d}.jpg" for i in range(1, 7)]
        assert cv2.imread(str(run / "images" / "000001.jpg")).shape == (24, 32, 3)


def test_the_journal_names_the_processor_of_each_frame_and_metadata_names_none_where_it_is_one(dataset):
    here = class_of(Path("/proc/cpuinfo").read_text(), platform.machine())
    if core_type := os.environ.get("OPENBLAS_CORETYPE"):
        here += f" OPENBLAS_CORETYPE={core_type}"
    journals = sorted((dataset / ".stages/render").rglob("*.jsonl"))
    lines = [json.loads(line) for path in journals for line in path.read_text().splitlines()]
    assert [line["frame"]["cpu"] for line in lines] == [here] * 12
    assert f"\nCPU-Class: {here}\n" in (dataset / "bag-info.txt").read_text()
    assert "cpu_classes" not in (dataset / "metadata.json").read_text()


def test_both_routes_start_where_the_paper_says(dataset):
    for route, theta in (("CW", -math.pi / 2), ("CCW", math.pi / 2)):
        first = (dataset / route / "test_1" / "data.csv").read_text().splitlines()[1].split(",")
        assert [float(value) for value in first[1:4]] == pytest.approx([0.55, -0.20, theta], abs=1e-6)


def test_metadata_holds_every_drawn_value_and_nothing_of_this_machine(dataset):
    text = (dataset / "metadata.json").read_text()
    metadata = json.loads(text)
    for run in metadata["runs"]:
        spec = json.loads((dataset / run["run"] / "side" / "spec.json").read_text())
        assert run["drawn"] == spec["drawn"]
        assert run["drawn"], "the shipped look draws its lights"
        assert run["render_device"] == "CPU"
        assert run["rendering"]["light_paths"]["clamp"] > 0
        for path, value in run["drawn"].items():
            node = spec
            for key in path.split("."):
                node = node[int(key)] if isinstance(node, list) else node[key]
            assert node == value, path
    assert os.uname().nodename not in text
    assert str(dataset.parent) not in text


def test_sha256sum_accepts_the_manifests(dataset):
    for name in ("manifest-sha256.txt", "tagmanifest-sha256.txt"):
        checked = subprocess.run(
            [shutil.which("sha256sum"), "-c", "--quiet", "--strict", name],
            cwd=dataset,
            capture_output=True,
            check=False,
        )
        assert checked.returncode == 0, checked.stdout
    listed = {line.split("  ")[1] for line in (dataset / "manifest-sha256.txt").read_text().splitlines()}
    there = {p.relative_to(dataset).as_posix() for p in dataset.rglob("*") if p.is_file() and ".stages" not in p.parts}
    assert listed == there - {"manifest-sha256.txt", "tagmanifest-sha256.txt"}


def test_the_bag_info_counts_the_payload_and_names_the_processor(dataset):
    """Payload-Oxum as RFC 8493 defines it in section 2.2.2: octets, a point, files."""
    info = dict(line.split(": ", 1) for line in (dataset / "bag-info.txt").read_text().splitlines())
    payload = [p for p in dataset.rglob("*") if p.is_file() and ".stages" not in p.parts and "txt" not in p.suffix]
    payload += dataset.glob("*/test_1/image_positions.txt")
    assert info["Payload-Oxum"] == f"{sum(path.stat().st_size for path in payload)}.{len(payload)}"
    assert info["External-Identifier"] == "smoke"
    assert platform.machine().split("_")[0] in info["CPU-Class"]
    assert os.uname().nodename not in info.values()


def test_stages_one_by_one_with_more_workers_and_smaller_blocks_give_the_same_bytes_and_refuse_another_order(
    dataset, tmp_path, symolo, tiny, release_of
):
    """Where the dataset was made by one command and one worker, a run here is rendered by two workers at once; the
    other one has the images of the dataset.
    """
    out = tmp_path / "staged"
    for early in ("render", "assemble"):
        refused = symolo(early, "smoke", "--out", out, *tiny)
        assert (refused.code, refused.err.count("\n")) == (2, 1)
        assert "symolo simulate" in refused.err
        assert not out.exists()
    assert symolo("simulate", "smoke", "--out", out, *tiny, "--workers", 2).code == 0
    assert symolo("assemble", "smoke", "--out", out, *tiny).code == 2
    shutil.copytree(dataset / ".stages/render/CCW", out / ".stages/render/CCW")
    assert symolo("render", "smoke", "--out", out, *tiny, "--workers", 2).code == 0
    assert not (out / "CW").exists()
    assert symolo("assemble", "smoke", "--out", out, *tiny).code == 0
    assert release_of(out) == release_of(dataset)


def test_a_second_release_touches_nothing(dataset, copy_of, symolo, tiny):
    out = copy_of(dataset, stages=True)
    before = {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.is_file()}
    assert symolo("release", "smoke", "--out", out, *tiny).code == 0
    assert {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.is_file()} == before


@pytest.mark.usefixtures("hands")
def test_another_look_is_rendered_again_but_not_simulated(dataset, copy_of, symolo, tiny):
    """And a route that the scenario no longer has is taken back."""
    out = copy_of(dataset, stages=True)
    trajectory = out / ".stages/simulate/CW/test_1/trajectory.npz"
    before = trajectory.stat().st_mtime_ns
    sun = ("look.sun.elevation_deg=70", "look.sun.illuminance_klx=60")
    sunny = [*tiny, f"--set={ONE_ROUTE}", *(f"--set={setting}" for setting in sun)]
    ended = symolo("release", "smoke", "--out", out, *sunny, "--replace")
    assert ended.code == 0
    assert "simulate: 1 of 1 run done before" in ended.err
    assert "the images there differ: look.sun.elevation_deg" in ended.err
    assert "-> 70.0" in ended.err
    assert trajectory.stat().st_mtime_ns == before
    run = "CW/test_1"
    assert (out / run / "data.csv").read_bytes() == (dataset / run / "data.csv").read_bytes()
    assert (out / run / "images/000001.jpg").read_bytes() != (dataset / run / "images/000001.jpg").read_bytes()
    assert json.loads((out / run / "side/spec.json").read_text())["look"]["sun"]["elevation_deg"] == 70
    assert not (out / "CCW").exists()
    assert symolo("verify", out).code == 0


def test_a_damaged_image_in_the_stages_and_the_release_is_made_again(dataset, copy_of, symolo, tiny, release_of):
    out = copy_of(dataset, stages=True)
    for damaged in (out / ".stages/render/CW/test_1/images/000003.jpg", out / "CW/test_1/images/000003.jpg"):
        data = bytearray(damaged.read_bytes())
        data[len(data) // 2] ^= 1
        damaged.write_bytes(data)
    assert symolo("release", "smoke", "--out", out, *tiny, "--workers", 1).code == 0
    assert release_of(out) == release_of(dataset)


@pytest.mark.usefixtures("hands")
def test_a_run_that_touches_something_is_reported_and_no_longer_released(
    dataset, copy_of, tmp_path, symolo, tiny, release_of
):
    """If it was released before, only with `--replace`.

    A sill below the range sensors' beams stands in the way of the counter-clockwise route alone.
    """
    (tmp_path / "sill.yaml").write_text(ARENA_WITH_A_SILL)
    out = copy_of(dataset, stages=True)
    arguments = ("release", "smoke", "--out", out, *tiny, "--set", f"arena={tmp_path / 'sill.yaml'}")
    refused = symolo(*arguments)
    assert refused.code == 2
    message = refused.err.splitlines()[-1]
    assert "1 released run failed now, and no run was removed from the finished dataset; CCW/test_1: " in message
    assert "simulate: touched sill at 0." in message
    assert message.endswith(f"see `symolo status {out}`, or give --replace")
    assert release_of(out) == release_of(dataset)
    ended = symolo(*arguments, "--replace")
    assert ended.code == 3
    (line,) = [line for line in ended.err.splitlines() if line.startswith("failed")]
    assert line.startswith("failed: CCW/test_1: simulate: touched sill at 0.")
    assert "removed: CCW/test_1, which has failed" in ended.err.splitlines()
    assert not (out / "CCW").exists()
    assert [run["run"] for run in json.loads((out / "metadata.json").read_text())["runs"]] == ["CW/test_1"]
    assert "touched sill" in (out / "README.md").read_text()
    assert symolo("verify", out).code == 0
    again = symolo(*arguments)
    assert again.code == 3
    assert "2 of 2 runs done before" in again.err


@pytest.mark.faults
def test_killed_and_interrupted_at_any_stage_it_ends_with_the_same_bytes(dataset, tmp_path, symolo, tiny, release_of):
    out = tmp_path / "killed"
    arguments = ("release", "smoke", "--out", out, *tiny, "--workers", 2)
    images = out / ".stages/render"

    interrupted = symolo.start(*arguments)
    _wait_for(out.exists)
    interrupted.send_signal(signal.SIGINT)
    _, err = interrupted.communicate(timeout=30)
    assert interrupted.returncode == 130
    assert "Traceback" not in err

    killed = symolo.start(*arguments)
    _wait_for(lambda: any(images.rglob("*.jpg")))
    children = _descendants(killed.pid)
    killed.kill()
    killed.communicate()
    assert children, "there were workers to be left behind"
    _wait_for(lambda: not any(Path(f"/proc/{pid}").exists() for pid in children))
    assert not (out / "metadata.json").exists()
    done_before = set(images.rglob("*.jpg"))

    bereft = symolo.start(*arguments)
    simulated = out / ".stages/simulate/CCW/test_1/done.json"
    worker, *_ = _wait_for(lambda: simulated.exists() and _workers(bereft.pid))
    os.kill(worker, signal.SIGKILL)
    _, err = bereft.communicate(timeout=120)
    assert bereft.returncode == 0, "another worker takes the unit over"
    assert sum("SIGKILL" in line and "trying again" in line for line in err.splitlines()) == 1

    assert done_before <= set(images.rglob("*.jpg"))
    assert release_of(out) == release_of(dataset)


def test_a_release_of_a_version_without_scene_json_gets_it_and_nothing_is_rendered(
    dataset, copy_of, symolo, tiny, release_of
):
    out = copy_of(dataset, stages=True)
    for path in sorted(out.rglob("assemble/*/test_1/done.json")):
        done = json.loads(path.read_text())
        stages = {name: json.loads((out / ".stages" / name / path.parents[1].name / "test_1/done.json").read_text())
                  for name in ("simulate", "render")}  # fmt: skip
        files = {name: stage["files"] for name, stage in stages.items()}
        done["key"] = input_key("assemble", stages=files, versions=versions("symolo", "numpy"))  # as it was before
        del done["files"]["side/scene.json"]
        path.write_text(json.dumps(done))
        (out / path.parents[1].name / "test_1/side/scene.json").unlink()
    rendered = {path: path.stat().st_mtime_ns for path in (out / ".stages/render").rglob("*")}
    assert symolo("release", "smoke", "--out", out, *tiny).code == 0
    assert release_of(out) == release_of(dataset)
    assert {path: path.stat().st_mtime_ns for path in (out / ".stages/render").rglob("*")} == rendered


def test_two_commands_do_not_work_in_one_folder(dataset, copy_of, symolo, tiny):
    out = copy_of(dataset, stages=True)
    with Workspace(out).locked():
        ended = symolo("release", "smoke", "--out", out, *tiny)
    assert ended.code == 2
    assert "another symolo command" in ended.err


@pytest.mark.parametrize("taken_back", [False, True])
def test_a_kill_while_an_old_run_is_removed_leaves_nothing_behind(
    dataset, copy_of, symolo, tiny, release_of, monkeypatch, taken_back
):
    """The run is renamed already; what a kill in the middle of writing a file leaves is there as well."""
    out = copy_of(dataset, stages=True)
    if taken_back:
        (out / "CW/test_2").mkdir()
        (out / "CW/test_2/data.csv").write_text("of a scenario with more runs")
        shutil.copytree(out / ".stages/assemble/CW/test_1", out / ".stages/assemble/CW/test_2")
    else:
        (out / "CW/test_1/data.csv").write_text("damaged")
    rmtree = shutil.rmtree

    def killed(path, **options):
        if path == out / f"CW/.test_{1 + taken_back}.dropped" and path.exists():
            raise KeyboardInterrupt
        rmtree(path, **options)

    monkeypatch.setattr(shutil, "rmtree", killed)
    assert symolo("release", "smoke", "--out", out, *tiny, *(["--replace"] if taken_back else [])).code == 130
    monkeypatch.undo()
    assert any(out.glob("CW/.*.dropped")), "it was interrupted in the middle"
    (out / ".metadata.json.123.tmp").write_text("{")
    assert symolo("release", "smoke", "--out", out, *tiny).code == 0
    assert release_of(out) == release_of(dataset)
    assert {p.name for p in (out / "CW").iterdir()} == {"test_1"}


def test_a_folder_that_is_removed_takes_along_what_a_killed_removal_left(tmp_path):
    (tmp_path / ".run.dropped").mkdir()
    remove_folder(tmp_path / "run")
    assert not any(tmp_path.iterdir())


@pytest.mark.usefixtures("hands")
def test_a_release_without_its_stages_is_made_again(tmp_path, symolo, tiny, release_of):
    """A run that the scenario no longer holds goes, although no stage knows of it; one outside the dataset stays."""
    out = tmp_path / "data"
    assert symolo("release", "smoke", "--out", out, *tiny).code == 0
    before = release_of(out)
    remove_folder(out / ".stages")
    (tmp_path / "test_1").mkdir()
    metadata = json.loads((out / "metadata.json").read_text())
    metadata["runs"] += [{**metadata["runs"][0], "run": run} for run in ("CW/test_2", "../test_1")]
    (out / "metadata.json").write_text(json.dumps(metadata))
    shutil.copytree(out / "CW/test_1", out / "CW/test_2")
    assert symolo("release", "smoke", "--out", out, *tiny, "--replace").code == 0
    assert release_of(out) == before
    assert (tmp_path / "test_1").is_dir()


def test_an_error_of_the_work_itself_is_not_taken_for_another_command(tmp_path):
    with pytest.raises(BlockingIOError), Workspace(tmp_path).locked():
        raise BlockingIOError


def _wait_for(condition, timeout_s=60.0):
    """What it is, once that is true."""
    end = time.monotonic() + timeout_s
    while not (met := condition()):
        assert time.monotonic() < end, "it did not happen in time"
        time.sleep(0.02)
    return met


def _descendants(pid):
    """Children by any thread, and theirs; what ends while it is counted is left out."""
    found = []
    with contextlib.suppress(*ENDED):
        for task in list(Path(f"/proc/{pid}/task").iterdir()):
            with contextlib.suppress(*ENDED):
                children = [int(child) for child in (task / "children").read_text().split()]
                found += [*children, *(below for child in children for below in _descendants(child))]
    return found


def _workers(pid):
    """Children that run a unit of work already."""
    return [child for child in _descendants(pid) if b"pipeline.work.worker_main" in _command_of(child)]


def _command_of(pid):
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes()
    except ENDED:
        return b""

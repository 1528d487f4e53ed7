"""`symolo status` says what is done, what is missing and why, and changes nothing."""

import fcntl
import json
import os

import pytest


@pytest.fixture
def out(dataset, copy_of):
    return copy_of(dataset, stages=True)


def test_a_finished_release_is_up_to_date(out, symolo, tiny):
    before = {path: path.stat().st_mtime_ns for path in out.rglob("*")}
    ended = symolo("status", out, "smoke", *tiny, "--check")
    assert ended.code == 0
    assert ended.out.splitlines()[:4] == [
        "no command is working here now",
        "runs: 2 of 2 released and up to date",
        "CW/test_1: simulate done; render done, 6 images; release done",
        "CCW/test_1: simulate done; render done, 6 images; release done",
    ]
    assert "release: every file as it was released" in ended.out
    assert "would be done" not in ended.out
    assert {path: path.stat().st_mtime_ns for path in out.rglob("*")} == before


def test_what_images_cost_is_summed_over_their_journals_and_threads(out, symolo, tiny):
    """Twelve images of 0.6 s on two threads, one of which was made again in 1.2 s on one: 15.6 core-seconds."""
    for journal in (out / ".stages/render").rglob("images.jsonl"):
        lines = [json.loads(line) for line in journal.read_text().splitlines()]
        for line in lines:
            line["frame"].update(seconds=0.6, threads=2)
        if "CCW" in journal.parts:
            lines.append({**lines[0], "frame": {**lines[0]["frame"], "seconds": 1.2, "threads": 1}})
        journal.write_text("".join(json.dumps(line) + "\n" for line in lines))
    assert "cost: 12 images took 0.00433 core-hours, 1.3 core-seconds each\n" in symolo("status", out).out
    assert "each; the plan was" in symolo("status", out, "smoke", *tiny).out


def test_a_folder_in_use_is_reported_with_the_process(out, symolo):
    descriptor = os.open(out / ".stages/.lock", os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        first = symolo("status", out).out.splitlines()[0]
    finally:
        os.close(descriptor)
    assert first.startswith("a command is working here now")
    assert str(os.getpid()) in first or "process" not in first


def test_an_interrupted_rendering_is_counted(out, symolo):
    (out / ".stages/render/CW/test_1/done.json").unlink()
    for number in (5, 6):
        (out / f".stages/render/CW/test_1/images/{number:06d}.jpg").unlink()
    printed = symolo("status", out).out
    assert "CW/test_1: simulate done; render 4 of 6 images; " in printed
    assert "would be done by the next release, 1 run (CW/test_1): render: some of its images are missing" in printed


def test_images_of_parts_that_are_all_there_only_have_to_be_checked(out, symolo):
    """`render --part K/N` leaves the stage open, since none of the parts knows when the others end."""
    (out / ".stages/render/CW/test_1/done.json").unlink()
    printed = symolo("status", out).out
    assert "CW/test_1: simulate done; render 6 of 6 images; " in printed
    assert "1 run (CW/test_1): render: all its images are there, and still have to be checked\n" in printed


def test_changed_fields_are_named_with_their_values(out, symolo, tiny):
    printed = symolo("status", out, "smoke", *tiny, "--set", "robot.drive.track_m=0.15").out
    assert "2 runs (CW/test_1, CCW/test_1): simulate: robot.drive.track_m 0.14 -> 0.15" in printed
    printed = symolo("status", out, "smoke", *tiny, "--set", "look.sun.elevation_deg=70").out
    assert "simulate: " not in printed
    assert "1 run (CW/test_1): render: look.sun.elevation_deg " in printed
    assert "-> 70.0" in printed


def test_a_release_of_a_version_without_scene_json_is_not_up_to_date(out, symolo, tiny):
    done = next((out / ".stages/assemble").glob("*/test_1/done.json"))
    whole = done.read_bytes()
    files = json.loads(whole)
    del files["files"]["side/scene.json"]
    done.write_text(json.dumps(files))
    printed = symolo("status", out, "smoke", *tiny).out
    done.write_bytes(whole)
    run = done.relative_to(out / ".stages/assemble").parent.as_posix()
    assert f"would be done by the next release, 1 run ({run}): release: side/scene.json is not among" in printed


def test_damage_and_failures_are_reported(out, symolo):
    image = out / ".stages/render/CW/test_1/images/000001.jpg"
    image.write_bytes(image.read_bytes()[:-1])
    without, checked = symolo("status", out), symolo("status", out, "--check")
    assert ("damaged" in without.out, without.code) == (False, 0)
    assert ("render damaged" in checked.out, checked.code) == (True, 4)
    outcome = out / ".stages/simulate/CCW/test_1/outcome.json"
    content = json.loads(outcome.read_text())
    outcome.write_text(json.dumps({**content, "problems": ["touched sill at 0.55 s"]}))
    printed = symolo("status", out).out
    assert "CCW/test_1: simulate failed: touched sill at 0.55 s" in printed
    assert "runs: 1 of 2 released and up to date; 1 failed\n" in printed


def test_a_changed_file_of_the_release_is_made_again_by_the_next_one(out, symolo):
    image = out / "CW/test_1/images/000001.jpg"
    whole = image.read_bytes()
    image.write_bytes(whole[:-1] + b"\0")
    without, checked = symolo("status", out), symolo("status", out, "--check")
    assert ("would be done" in without.out, without.code) == (False, 0)
    assert (
        "would be done by the next release, 1 run (CW/test_1): release: some of its files were changed" in checked.out
    )
    assert "runs: 1 of 2 released and up to date\n" in checked.out
    assert "release: 1 fault; `symolo verify` lists them\n" in checked.out
    assert checked.code == 4


def test_a_missing_file_of_a_stage_is_reported_without_hashing(out, symolo):
    (out / ".stages/render/CW/test_1/images/000001.jpg").unlink()
    printed = symolo("status", out).out
    assert "would be done by the next release, 1 run (CW/test_1): render: some of its files are missing\n" in printed


@pytest.mark.parametrize("name", ["CW/test_1/data.csv", "manifest-sha256.txt"])
def test_a_link_is_no_released_file(out, symolo, tmp_path, name):
    (out / name).rename(tmp_path / "elsewhere")
    (out / name).symlink_to(tmp_path / "elsewhere")
    expected = "release without data.csv" if name.endswith("csv") else "not finished, manifest-sha256.txt missing"
    assert expected in symolo("status", out).out


def test_what_is_no_output_folder_is_refused_in_one_line(out, tmp_path, symolo):
    (tmp_path / "empty").mkdir()
    for arguments in ((tmp_path / "none",), (tmp_path / "empty",), (out, "--set", "seed=1")):
        ended = symolo("status", *arguments)
        assert (ended.code, ended.err.count("\n")) == (2, 1)


def test_a_run_whose_folder_is_gone_is_damage(out, symolo):
    (out / "CW/test_1").rename(out.parent / "elsewhere")
    (out / "manifest-sha256.txt").rename(out.parent / "lists")
    checked = symolo("status", out, "--check")
    (out.parent / "elsewhere").rename(out / "CW/test_1")
    (out.parent / "lists").rename(out / "manifest-sha256.txt")
    assert checked.code == 4
    assert "its folder is missing" in checked.out

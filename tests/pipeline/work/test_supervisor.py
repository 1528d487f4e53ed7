"""The supervisor over workers that hang, crash, fall silent and take memory, played by a small script."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from pipeline.work.supervisor import Retried, run_units
from pipeline.work.units import Progress, RenderUnit
from pipeline.work.worker_process import WorkerLimits, limits_of
from symolo.core.child_process import Failed, Finished, memory_of
from symolo.core.errors import EnvironmentLacking

WORKER = r"""
import json, os, sys, time
from pathlib import Path

def say(kind, **more):
    print(json.dumps({"kind": kind, **more}), flush=True)

for line in sys.stdin:
    unit = json.loads(line)
    folder, names = Path(unit["folder"]), unit["name"].split()
    for number in unit["numbers"]:
        made = folder / f"{names[0]}_{number}"
        if made.exists():
            continue
        say("progress", share=0.5, at=number)
        tries = folder / f"{names[0]}_{number}.tries"
        tries.write_text(tries.read_text() + "x" if tries.exists() else "x")
        what = dict(part.split("=") for part in names[1:]).get(str(number), "")
        first = tries.read_text() == "x"
        if what == "die" or (what == "die_once" and first):
            os.kill(os.getpid(), 9)
        if what == "die_writing" and first:
            from symolo.core.files import atomic_files
            os.replace = lambda *_: os.kill(os.getpid(), 9)
            atomic_files.write_file(made, b"half")
        if what == "hang_writing":
            from symolo.core.files import atomic_files
            os.replace = lambda *_: (say("progress", share=0.5, at=99), time.sleep(60))
            atomic_files.write_file(made, b"half")
        if what == "hang_once" and first:
            time.sleep(60)
        if what == "eat_once" and first:
            eaten = b"x" * 400_000_000
            time.sleep(60)
        if what == "refuse":
            say("failed", error="engine", text="no"); break
        if what == "lack":
            say("failed", error="environment", text="no room"); break
        made.write_text(str(os.getpid()))
    else:
        say("finished")
"""
COMMAND = (sys.executable, "-c", WORKER)
IMPATIENT = WorkerLimits(silence_s=3.0)
FRUGAL = WorkerLimits(memory_bytes=200_000_000)


def unit(folder: Path, name: str, numbers=(1, 2, 3)) -> RenderUnit:
    """What comes after the name says which frames go wrong, and how."""
    (folder / "job.json").write_text("{}")
    return RenderUnit(work="images", name=name, job=folder / "job.json", folder=folder, numbers=numbers, threads=1)


@pytest.fixture(autouse=True)
def _seed(monkeypatch):
    monkeypatch.setattr("blender_scenes.render.renderer.seed_of", lambda _job, _work: 5)


def test_a_worker_takes_the_next_unit_and_the_next(tmp_path):
    names = [f"run{i}" for i in range(20)]
    assert run_units([unit(tmp_path, name) for name in names], 2, lambda *_: None, command=COMMAND) == []
    processes = {(tmp_path / f"{name}_{number}").read_text() for name in names for number in (1, 2, 3)}
    assert len(processes) <= 2


@pytest.mark.parametrize(
    ("what", "limits", "why"),
    [
        ("die_once", WorkerLimits(), "signal SIGKILL"),
        ("hang_once", IMPATIENT, "did not respond for 3 s"),
        # On a loaded machine it takes seconds to fill the memory, so this worker may be silent for longer.
        ("eat_once", FRUGAL, "GB of memory"),
    ],
)
def test_a_frame_at_which_a_worker_fails_once_is_made_by_the_next(tmp_path, what, limits, why):
    said = []
    units = [unit(tmp_path, f"bad 2={what}"), unit(tmp_path, "good")]
    failures = run_units(units, 1, lambda _unit, event: said.append(event), command=COMMAND, limits=limits)
    assert failures == []
    assert {p.name for p in tmp_path.glob("*_?")} == {f"{name}_{i}" for name in ("bad", "good") for i in (1, 2, 3)}
    (retried,) = [event for event in said if isinstance(event, Retried)]
    assert why in retried.text
    assert "image 2" in retried.text
    assert "trying again (2 of 3)" in retried.text
    assert [(tmp_path / f"bad_{i}.tries").read_text() for i in (1, 2, 3)] == ["x", "xx", "x"], "one frame was lost"


def test_what_a_killed_worker_left_unfinished_is_removed_and_what_another_command_is_writing_is_not(tmp_path):
    of_another = tmp_path / ".bad_2.0123456789abcdef.tmp"
    of_another.write_text("a part of the same release, written by another process at this moment")
    assert run_units([unit(tmp_path, "bad 2=die_writing")], 1, lambda *_: None, command=COMMAND) == []
    assert {p.name for p in tmp_path.glob("*bad_?*") if p.suffix != ".tries"} == {
        *(f"bad_{i}" for i in (1, 2, 3)),
        of_another.name,
    }


def test_nothing_unfinished_is_left_by_an_interrupt(tmp_path):
    def interrupted(_unit, event):
        if isinstance(event, Progress) and event.at == 99:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_units([unit(tmp_path, "bad 2=hang_writing")], 1, interrupted, command=COMMAND)
    assert {p.name for p in tmp_path.glob("*bad_?*") if p.suffix != ".tries"} == {"bad_1"}


@pytest.mark.parametrize("what", ["die", "refuse"])
def test_a_frame_that_fails_always_is_set_aside_with_its_seed_and_the_rest_goes_on(tmp_path, what):
    failures = run_units([unit(tmp_path, f"bad 2={what}"), unit(tmp_path, "good")], 1, lambda *_: None, command=COMMAND)
    (failure,) = failures
    assert failure.unit.name.startswith("bad")
    assert failure.text.startswith(
        "image 2 (seed 5) was given up after 3 tries; the same command tries this image again"
    )
    assert (tmp_path / "bad_2.tries").read_text() == "xxx"
    assert (tmp_path / "bad_3").exists()
    assert (tmp_path / "good_3").exists()


def test_a_unit_whose_every_frame_fails_comes_to_an_end(tmp_path):
    said = []
    name = "bad 1=refuse 2=refuse 3=refuse"
    failures = run_units([unit(tmp_path, name)], 1, lambda _unit, event: said.append(event), command=COMMAND)
    assert [failure.text.split(" (")[0] for failure in failures] == ["image 1", "image 2", "image 3"]
    assert isinstance(said[-1], Finished)


def test_what_the_machine_lacks_ends_all_at_once(tmp_path):
    units = [unit(tmp_path, "bad 1=lack"), unit(tmp_path, "later 1=hang_once")]
    begin = time.monotonic()
    with pytest.raises(EnvironmentLacking, match="no room"):
        run_units(units, 2, lambda *_: None, command=COMMAND)
    assert time.monotonic() - begin < 10


def test_no_worker_is_left_behind_and_nothing_in_the_temporary_folder(tmp_path, monkeypatch):
    """Neither when all is well nor when an interrupt comes in the midst of it."""
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(scratch))
    before, open_before = _children(), len(list(Path("/proc/self/fd").iterdir()))

    def interrupted(_unit, _event):
        raise KeyboardInterrupt

    run_units([unit(tmp_path, "good")], 1, lambda *_: None, command=COMMAND)
    with pytest.raises(KeyboardInterrupt):
        run_units([unit(tmp_path, "slow 1=hang_once")], 1, interrupted, command=COMMAND)
    assert _children() == before
    assert len(list(Path("/proc/self/fd").iterdir())) == open_before
    assert list(scratch.iterdir()) == []
    assert [thread.name for thread in threading.enumerate() if "(work" in thread.name or "(watch" in thread.name] == []


def test_memory_is_that_of_a_process_with_its_children():
    program = "kept = b'x' * 50_000_000; print(flush=True); input()"
    before = memory_of(os.getpid())
    with subprocess.Popen([sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as child:
        child.stdout.readline()
        assert 50e6 < memory_of(child.pid) < 80e6
        assert memory_of(os.getpid()) > before + 50e6
        child.kill()
    assert memory_of(2**22 + 1) == 0, "there is no such process"


def test_a_worker_may_take_what_is_asked_for_and_else_no_more_than_the_machine_has():
    assert limits_of(2.5).memory_bytes == 2_500_000_000
    kb = int(Path("/proc/meminfo").read_text().split("MemTotal:")[1].split()[0])
    assert 0 < limits_of(None).memory_bytes < 1024 * kb


def test_a_failure_of_the_work_itself_is_not_tried_again(tmp_path):
    failed = Failed(error="run", text="hit a wall").model_dump_json()
    said = []
    command = (sys.executable, "-c", f"import sys\nfor _ in sys.stdin: print({failed!r}, flush=True)")
    (failure,) = run_units([unit(tmp_path, "run")], 1, lambda _unit, event: said.append(event), command=command)
    assert failure.text == "hit a wall"
    assert [type(event) for event in said] == [Failed]


def _children() -> set[str]:
    tasks = Path(f"/proc/{os.getpid()}/task").iterdir()
    return {child for task in tasks for child in (task / "children").read_text().split()}


assert signal.SIGKILL == 9, "as the script has it"

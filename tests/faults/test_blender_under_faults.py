"""Real Blender processes: killed over and over, in every arrangement of threads, workers and order, and for very long.

Minutes each, so that all have the marker `faults`; what they show is shown once in the default run, by the tests of the
renderer, of the supervisor and of `release`.
"""

import contextlib
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pytest
import yaml

import configs
from blender_scenes.render.job import FramePose, build_job
from configs.schema.appearance.look import LookConfig
from configs.schema.arena import ArenaConfig
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Render
from pipeline.work.supervisor import Retried, run_units
from pipeline.work.units import Progress, RenderUnit
from symolo.arena.geometry import Arena
from symolo.core.child_process import memory_of

pytestmark = pytest.mark.faults

SHIPPED = Path(configs.__file__).parent
BARE = Path(__file__).parent / "bare.yaml"
MB = 1e6


def written_job(folder: Path, frames: int, width_px: int, samples: int) -> Path:
    """job.json of a bare room, in which the robot goes round."""
    arena = ArenaConfig.model_validate(yaml.safe_load((SHIPPED / "arenas/symolo.yaml").read_text()))
    robot = RobotConfig.model_validate(yaml.safe_load((SHIPPED / "robots/nominal.yaml").read_text()))
    angles = np.linspace(0, 2 * np.pi, frames, endpoint=False).tolist()
    poses = [
        FramePose(number=i, t_s=0.2 * i, x_m=0.5 * np.cos(a), y_m=0.5 * np.sin(a), yaw_rad=a + np.pi / 2)
        for i, a in enumerate(angles, 1)
    ]
    render = Render(width_px=width_px, height_px=width_px * 3 // 4, samples=samples)
    job = build_job(Arena.from_config(arena), robot, LookConfig(name="bare"), render, poses, seed=5)
    folder.mkdir(exist_ok=True)
    (folder / "job.json").write_text(job.to_json())
    return folder / "job.json"


def block(job: Path, folder: Path, numbers: Sequence[int], threads: int = 1) -> RenderUnit:
    return RenderUnit(
        work="images", name="run", job=job, folder=folder / "images", numbers=tuple(numbers), threads=threads
    )


def hashes_in(folder: Path) -> dict[str, str]:
    """SHA-256 of every file in the folder of images by name: whatever lies there besides counts too."""
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted((folder / "images").iterdir())}


def blenders(process: int | None = None) -> Iterator[int]:
    """Blender processes among what a process, this one by default, has started."""
    for task in Path(f"/proc/{process or os.getpid()}/task").iterdir():
        try:
            children = (task / "children").read_text().split()
        except OSError:
            continue
        for child in map(int, children):
            try:
                if b"blender_scenes.blender_side" in Path(f"/proc/{child}/cmdline").read_bytes():
                    yield child
                yield from blenders(child)
            except OSError:  # it has just ended
                continue


def test_blender_killed_200_times_loses_at_max_one_frame_each_time(tmp_path):
    frames, most = 300, int(os.environ.get("SYMOLO_KILLS", "200"))
    whole, instants, kills, lost = tmp_path / "whole", np.random.Generator(np.random.PCG64(7)), 0, 0
    job = written_job(whole, frames, 64, 8)
    assert run_units([block(job, whole, range(1, frames + 1))], 1, lambda *_: None) == []
    killed_at: list[int] = []
    over = threading.Event()

    def kill_now_and_then() -> None:
        while not over.is_set() and len(killed_at) < most:
            time.sleep(float(instants.uniform(0.5, 4)))
            for process in blenders():
                os.kill(process, signal.SIGKILL)
                killed_at.append(process)

    killer = threading.Thread(target=kill_now_and_then)
    killer.start()
    try:
        while len(killed_at) < most:
            out, begun = tmp_path / f"out_{kills}", Counter()
            out.mkdir()
            before = len(killed_at)

            def heard(_unit, event, begun=begun):
                if isinstance(event, Progress) and event.at is not None:
                    begun[event.at] += 1

            while run_units([block(job, out, range(1, frames + 1))], 1, heard):
                pass  # a frame killed three times over is set aside; the command is given again
            assert hashes_in(out) == hashes_in(whole)
            journal = [json.loads(line)["frame"]["number"] for line in (out / "images.jsonl").read_text().splitlines()]
            assert sorted(journal) == list(range(1, frames + 1)), "a frame that was recorded is not made again"
            lost += sum(begun.values()) - frames
            kills = len(killed_at)
            assert sum(begun.values()) - frames <= kills - before
            shutil.rmtree(out)
    finally:
        over.set()
        killer.join()
    print(f"{kills} kills, {lost} frames made twice")  # noqa: T201 - the figure


@pytest.mark.parametrize("method", ["full", "hybrid"])
def test_a_release_killed_while_blender_renders_ends_with_the_same_tree(method, tmp_path, wrong, tree):
    """Blender and the command itself in turns, at any time from Blender's start to the last image."""
    undisturbed, out = tmp_path / "undisturbed", tmp_path / "killed"
    release = _releasing(undisturbed, method)
    begin = _when_blender_starts(release)
    assert release.wait() == 0
    rendering_s = time.monotonic() - begin
    whole = tree(undisturbed)
    instants, most = np.random.Generator(np.random.PCG64(11)), int(os.environ.get("SYMOLO_KILLS", "12"))
    killed, releases = Counter(), 0
    while killed.total() < most:
        status = -signal.SIGKILL
        while status != 0:
            release = _releasing(out, method)
            while killed.total() < most and _when_blender_starts(release):
                time.sleep(float(instants.uniform(0, rendering_s)))
                _kill(release, killed)
            status = release.wait()
            assert status in {0, 3, -signal.SIGKILL}  # 3: three of its Blenders were killed at the same frame
            assert wrong(out, whole) == []
        assert tree(out) == whole
        shutil.rmtree(out)
        releases += 1
    print(f"{killed['Blender']} kills of Blender, {killed['command']} of the command, {releases} releases")  # noqa: T201


def _releasing(out: Path, method: str) -> subprocess.Popen:
    settings = ("render.samples=null", f"render.method={method}", "stop.time_limit_s=1.4")
    arguments = ["release", str(BARE), "--out", str(out), "--workers", "1", *(f"--set={one}" for one in settings)]
    program = "import sys; from pipeline.cli import main; sys.exit(main(sys.argv[1:]))"
    return subprocess.Popen([sys.executable, "-c", program, *arguments], stderr=subprocess.DEVNULL)


def _when_blender_starts(release: subprocess.Popen) -> float | None:
    """None where the command ends before."""
    while release.poll() is None:
        if any(blenders(release.pid)):
            return time.monotonic()
        time.sleep(0.05)
    return None


def _kill(release: subprocess.Popen, killed: Counter) -> None:
    """Its Blender or the command, where there are both; ends when there is no Blender left."""
    rendering = list(blenders(release.pid))
    if not rendering or release.poll() is not None:
        return
    victim, process = ("Blender", rendering[0]) if killed["Blender"] <= killed["command"] else ("command", release.pid)
    with contextlib.suppress(ProcessLookupError):
        os.kill(process, signal.SIGKILL)
        killed[victim] += 1
    while any(Path(f"/proc/{one}").exists() for one in rendering):
        time.sleep(0.05)


def test_threads_workers_order_and_interruptions_change_no_byte(tmp_path):
    frames, order = 8, np.random.Generator(np.random.PCG64(3))
    job = written_job(tmp_path / "job", frames, 48, 4)
    found = {}
    for threads in (1, 2, 4):
        for workers in (1, 2, 4):
            for shuffled in (False, True):
                for resumed in (False, True):
                    numbers = list(range(1, frames + 1))
                    if shuffled:
                        order.shuffle(numbers)
                    out = tmp_path / f"{threads}_{workers}_{shuffled}_{resumed}"
                    out.mkdir()
                    units = [block(job, out, numbers[slot::workers], threads) for slot in range(workers)]
                    if resumed:
                        _interrupted(units, workers)
                    assert run_units(units, workers, lambda *_: None) == []
                    found[out.name] = hashes_in(out)
    assert len(found) == 36
    assert len({tuple(hashes.items()) for hashes in found.values()}) == 1


def _interrupted(units: Sequence[RenderUnit], workers: int) -> None:
    made = Counter()

    def stop_at_the_third(_unit, event):
        made.update([isinstance(event, Progress) and event.at is not None])
        if made[True] == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_units(units, workers, stop_at_the_third)


def test_ten_thousand_frames_take_no_more_memory_nor_files_and_leave_no_zombies(tmp_path):
    frames = int(os.environ.get("SYMOLO_FRAMES", "10000"))
    job = written_job(tmp_path, frames, 24, 1)
    seen: list[tuple[int, float, int, int]] = []

    def heard(_unit, event):
        if isinstance(event, Progress) and event.at is not None and event.at % 100 == 0:
            for process in blenders():
                opened = len(list(Path(f"/proc/{process}/fd").iterdir()))
                seen.append((event.at, memory_of(process) / MB, opened, _zombies()))
        assert not isinstance(event, Retried), event

    begin = time.monotonic()
    assert run_units([block(job, tmp_path, range(1, frames + 1))], 1, heard) == []
    settled = [row for row in seen if row[0] >= min(500, frames // 4)]
    growth = max(row[1] for row in settled) - settled[0][1]
    print(f"{frames} frames in {time.monotonic() - begin:.0f} s; {settled[0]} ... {settled[-1]}; {growth:.1f} MB")  # noqa: T201
    assert len(hashes_in(tmp_path)) == frames
    assert growth < 50
    assert settled[-1][2] <= settled[0][2]
    assert max(row[3] for row in seen) == 0


def _zombies() -> int:
    """Processes of this machine that ended and were not waited for, among those that descend from this one."""
    found = 0
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        found += fields[0] == "Z" and int(fields[2]) in {os.getpgrp(), *(os.getpgid(pid) for pid in blenders())}
    return found

"""Parts of the work that nobody deals out: every unit in exactly one, whatever else is there."""

import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from pipeline.executors.local import Local
from pipeline.executors.part import BLOCK_FRAMES, PartOfWork
from pipeline.work.units import RenderUnit, SimulateUnit
from symolo.core.errors import InputError


def _block(run, first):
    numbers = tuple(range(first, first + BLOCK_FRAMES))
    return RenderUnit(name=run, work="images", job=Path(), folder=Path(), numbers=numbers, threads=1)


def _parts(of):
    return [PartOfWork(number, of, Local(1)) for number in range(1, of + 1)]


UNITS = [
    *(_block(f"CW/test_{run}", 1 + BLOCK_FRAMES * i) for run in range(1, 41) for i in range(8)),
    *(SimulateUnit(name=f"CW/test_{run}", spec="", folder=Path(), key="") for run in range(1, 41)),
]


@pytest.mark.parametrize("of", [1, 2, 3, 10, 400])
def test_every_unit_is_in_exactly_one_part(of):
    assert [sum(part.mine(unit) for part in _parts(of)) for unit in UNITS] == [1] * len(UNITS)


@pytest.mark.parametrize("of", [2, 4, 8])
def test_blocks_are_shared_evenly_where_each_run_has_a_multiple(of):
    shares = Counter(part.number for part in _parts(of) for unit in UNITS[:320] if part.mine(unit))
    assert set(shares.values()) == {320 // of}


@pytest.mark.parametrize("text", ["0/2", "3/2", "1", "1/0", "a/b", "1/2/3", "-1/2", "1/1000000", ""])
def test_what_is_no_part_is_refused(text):
    with pytest.raises(InputError, match="--part"):
        PartOfWork.of_text(text, Local(1))


def test_a_part_is_read_from_one():
    assert PartOfWork.of_text("3/10", Local(2)) == PartOfWork(3, 10, Local(2))


def _started(*arguments):
    program = "import sys; from pipeline.cli import main; sys.exit(main())"
    return subprocess.Popen([sys.executable, "-P", "-c", program, *map(str, arguments)])


@pytest.mark.faults
@pytest.mark.parametrize("parts", [("1/2", "2/2"), ("1/2", "2/2", "1/1"), ("1/3", "1/3", "2/3", "3/3")])
def test_processes_that_know_nothing_of_each_other_make_the_release_of_one(tmp_path, release_of, parts):
    small = ["--set=stop.time_limit_s=11", "--set=render.width_px=32", "--set=render.height_px=24"]
    small += ["--set=render.samples=1", "--workers=1"]
    alone, together = tmp_path / "alone", tmp_path / "together"
    for command in ("simulate", "render"):
        jobs = [_started(command, "smoke", "--out", together, *small, "--part", part) for part in parts]
        assert [job.wait() for job in jobs] == [0] * len(jobs)
    frames = {path: path.stat().st_mtime_ns for path in together.rglob("*.jpg")}
    assert len(frames) == 2 * 56
    for out in (together, alone):
        assert _started("release", "smoke", "--out", out, *small).wait() == 0
    assert {path: path.stat().st_mtime_ns for path in frames} == frames
    assert release_of(together) == release_of(alone)

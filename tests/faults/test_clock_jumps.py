"""A wall clock that jumps while commands work: no byte depends on it, and no time on the screen is absurd."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.compiler

FOLDER = Path(__file__).parent
DURATION = re.compile(r"(-?[\d.]+) (s|min|h|core-hours|core-seconds)\b")
FORMATS = "tum,kitti,webdataset,parquet,mcap,hdf5,lerobot,rerun,ros1,huggingface"


@pytest.fixture(scope="module")
def jumping_clock(tmp_path_factory):
    """Environment in which the wall clock jumps with every seventh look at it: hours, years, to 1970 and to 2100."""
    library = tmp_path_factory.mktemp("clock") / "jumping_clock.so"
    flags = ["-O1", "-shared", "-fPIC", "-o", library]
    subprocess.run([shutil.which("gcc") or "gcc", *flags, FOLDER / "jumping_clock.c"], check=True)
    return {"LD_PRELOAD": str(library)}


def absurd_times(messages):
    """Return what is no time that a tiny release takes: less than nothing, or an hour and more."""
    longest = {"s": 3600.0, "min": 60.0, "h": 0.0, "core-hours": 1.0, "core-seconds": 3600.0}
    return [found.group() for found in DURATION.finditer(messages) if not 0 <= float(found[1]) < longest[found[2]]]


def test_the_clock_of_these_tests_jumps(jumping_clock):
    look = "import time\nseen = [time.time() for _ in range(90)]\nprint(min(seen), max(seen))\nprint(time.monotonic())"
    command = [sys.executable, "-S", "-c", look]
    ended = subprocess.run(command, env={**os.environ, **jumping_clock}, capture_output=True, text=True, check=True)
    first, last, _ = map(float, ended.stdout.split())
    assert (first < 1, last > 4.1e9) == (True, True)
    assert absurd_times("render: 2 of 2 images in -3.0 s, about 5 h 10 min left") == ["-3.0 s", "5 h"]


def test_a_release_that_is_killed_and_goes_on_has_the_same_bytes(jumping_clock, server_with, whole, tree, tmp_path):
    server, out = server_with(**jumping_clock), tmp_path / "data"
    writes = [at for at, (name, _) in enumerate(whole.operations, 1) if name == "write"]
    assert server.release(out, root=str(tmp_path), at=writes[len(writes) // 2], error=-9).status == -9
    messages = ""
    for command in ("status", "release", "status", "verify"):
        arguments = {} if command == "release" else {"arguments": [command, str(out)]}
        ended = server.release(out, **arguments)
        assert (ended.status, "Traceback" in ended.err) == (0, False), ended.err
        messages += ended.err
    assert "1 of 1 run" in messages
    assert "cost: 2 images took" in messages
    assert absurd_times(messages) == []
    assert tree(out) == whole.tree


@pytest.mark.faults
def test_real_workers_exports_and_pages_have_the_same_bytes(jumping_clock, tree, tmp_path):
    """Of Blender, and of the libraries that write archives, tables and plots."""

    def made(name, environment):
        folder = tmp_path / name
        folder.mkdir()
        for arguments in (
            ["release", FOLDER / "bare.yaml", "--workers", "2", "--out", "data"],
            ["export", "data", "--format", FORMATS, "--out", "exported"],
            ["bag", "data", "--out", "bag"],
            ["upload", "data", f"file://{folder}/shelf"],
            ["download", f"file://{folder}/shelf", "--out", "fetched"],
            ["report", "data", "--out", "report.html"],
            ["contact-sheet", "data", "--out", "sheet.jpg"],
            ["view", "data", "--out", "view.html"],
            ["video", "data", "--out", "video.mp4", "--width-px", "320", "--fps", "2"],
        ):
            command = [sys.executable, "-c", "import sys; from pipeline.cli import main; sys.exit(main())"]
            ended = subprocess.run(
                [*command, *map(str, arguments)],
                cwd=folder,
                env={**os.environ, **environment, "PYTHONPATH": str(FOLDER.parents[1])},
                capture_output=True,
                text=True,
                check=False,
            )
            assert (ended.returncode, absurd_times(ended.stderr)) == (0, []), ended.stderr
        return tree(folder)

    assert made("jumping", jumping_clock) == made("steady", {})

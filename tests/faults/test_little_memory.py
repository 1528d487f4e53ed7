"""Commands whose processes may address little memory: one line that names memory, and the same command goes on."""

import os
import resource
import subprocess
import sys
import time
from pathlib import Path

import pytest

from pipeline.cli import main

MB = 1_000_000
CURE = "run the same command again"
SCENARIO = Path(__file__).with_name("bare.yaml")
DATASET = Path(__file__).parents[1] / "fuzz/corpus/dataset/valid"


def limited(limit_mb, *arguments):
    """Run a command whose processes may address that much memory; return its exit code and messages."""

    def limit():
        if limit_mb:
            resource.setrlimit(resource.RLIMIT_AS, (limit_mb * MB, limit_mb * MB))

    command = [
        sys.executable,
        "-c",
        "import sys; from pipeline.cli import main; sys.exit(main())",
        *map(str, arguments),
    ]
    ended = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600, preexec_fn=limit)
    return ended.returncode, ended.stderr


@pytest.mark.parametrize("limit_mb", [60, 350, 900])
def test_a_limit_that_no_library_fits_in_is_refused_at_once(limit_mb):
    """With 350 MB, OpenBLAS would ask for more without end while it is loaded, and heed no signal."""
    begin = time.monotonic()
    code, messages = limited(limit_mb, "plan", SCENARIO)
    assert time.monotonic() - begin < 60
    assert code == 5
    assert messages.startswith("symolo: there is not enough memory")
    assert messages.endswith(f"{CURE}\n")
    assert len(messages.splitlines()) == 1


def test_a_limit_in_which_the_libraries_fit_is_none(monkeypatch, capsys):
    needed_mb = 1000 + 100 * (os.cpu_count() or 1)
    for limit_mb, code in ((needed_mb, 0), (needed_mb - 1, 5)):
        monkeypatch.setattr(resource, "getrlimit", lambda _, limit_mb=limit_mb: (limit_mb * MB, resource.RLIM_INFINITY))
        assert main(["--version"]) == code
    assert f"may address {needed_mb - 1} MB, and its libraries need up to {needed_mb} MB" in capsys.readouterr().err


BUFFERS = """
import resource
from pathlib import Path
import numpy as np
import scipy.linalg
from pipeline.address_space import check_address_space
resource.setrlimit(resource.RLIMIT_AS, (10**12, resource.RLIM_INFINITY))
check_address_space()
used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + 1_000_000, resource.RLIM_INFINITY))
print(np.linalg.inv(2.0 * np.eye(2))[0, 0], scipy.linalg.inv(4.0 * np.eye(2))[0, 0])
"""


def test_after_the_start_of_a_command_no_inverse_waits_for_memory_without_end():
    """OpenBLAS asks again and again for the memory of its first call, and heeds no signal but the last one."""
    ended = subprocess.run([sys.executable, "-c", BUFFERS], capture_output=True, text=True, timeout=60, check=True)
    assert ended.stdout.split() == ["0.5", "0.25"]


THREADS = """
import resource, sys
from pathlib import Path
from symolo.core.os_errors import lacking
from symolo.storage.side_by_side import side_by_side
used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + int(sys.argv[1]) * 1_000_000, resource.RLIM_INFINITY))
try:
    print(sorted(result for _, result in side_by_side(abs, range(-3, 0))))
except (MemoryError, RuntimeError) as error:
    print(lacking(error))
"""


@pytest.mark.parametrize(
    ("room_mb", "result"), [(1, "not enough memory"), (100, "not enough memory"), (1000, "[1, 2, 3]")]
)
def test_too_little_memory_for_threads_is_an_error_and_no_wait_without_end(room_mb, result):
    """A thread that runs out of memory while it starts would leave Python 3.11 waiting for it."""
    command = [sys.executable, "-c", THREADS, str(room_mb)]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    assert result in ended.stdout


@pytest.mark.faults
def test_with_any_limit_a_release_is_whole_or_names_the_memory_and_goes_on_without_the_limit(wrong, tree, tmp_path):
    release = ["release", SCENARIO, "--workers", 1, "--out"]
    assert limited(0, *release, tmp_path / "whole")[0] == 0
    expected = tree(tmp_path / "whole")
    codes = set()
    for limit_mb in (1000, 1200, 1400, 1600, 1800, 2000, 2500, 3000):
        out = tmp_path / str(limit_mb)
        code, messages = limited(limit_mb, *release, out)
        assert "Traceback" not in messages
        assert (code, "memory" in messages) in {(0, False), (3, True), (5, True)}, messages
        assert wrong(out, expected) == []
        assert limited(0, *release, out)[0] == 0
        assert tree(out) == expected
        codes.add(code)
    assert codes > {0}


@pytest.mark.faults
@pytest.mark.parametrize(
    "arguments",
    [
        ("verify", DATASET),
        ("export", DATASET, "--format", "tum,parquet,mcap,hdf5", "--out"),
        ("diagnose", "table-1", "--workers", 1, "--out"),
    ],
    ids=lambda arguments: arguments[0],
)
def test_with_any_limit_it_is_done_or_names_the_memory_and_is_done_without_the_limit(arguments, wrong, tree, tmp_path):
    writes = arguments[-1] == "--out"
    assert limited(0, *arguments, *([tmp_path / "whole"] * writes))[0] == 0
    expected = tree(tmp_path / "whole")
    codes = set()
    for limit_mb in (900, 1200, 1300, 1400, 1600, 1800, 2000, 2500, 3000):
        out = tmp_path / str(limit_mb)
        code, messages = limited(limit_mb, *arguments, *([out] * writes))
        named = [line for line in messages.splitlines() if line.startswith("symolo: ")]
        assert "Traceback" not in messages
        assert (code, len(named)) in {(0, 0), (5, 1)}, messages
        assert all("memory" in line for line in named)
        assert wrong(out, expected) == []
        if writes and (code or tree(out) != expected):
            assert limited(0, *arguments, out)[0] == 0
        assert tree(out) == expected
        codes.add(code)
    assert codes == {0, 5}

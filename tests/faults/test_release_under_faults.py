"""A small release killed at random instants, on a full disk, and with every file operation failing in its turn.

After each fault every file that is seen under its name is whole, and the same command again ends with the tree of a
release that nothing disturbed. The full forms have the marker `faults`.
"""

import errno
import re
import shutil
import signal
from pathlib import Path

import numpy as np
import pytest

KILL = -signal.SIGKILL  # as `FileOperations` has it
ERRORS = (errno.EIO, errno.ENOSPC, errno.EDQUOT, errno.EACCES, errno.EMFILE)
DOCUMENTED = {2, 5}
"""Exit codes for an operation that failed: what was given cannot be used, or the machine lacks something."""


def _full(*values):
    """Parameters of the full form, after those of the short one."""
    return pytest.param(*values, marks=pytest.mark.faults)


@pytest.fixture
def check(server, whole, wrong, tree):
    """That a folder shows nothing wrong and that the same command again completes it."""

    def checked(out: Path, what: object, *, finish: bool = True) -> None:
        assert wrong(out, whole.tree) == [], what
        if (out / "manifest-sha256.txt").exists():
            named = {name for name in whole.tree if not name.startswith(".stages/")} - {"tagmanifest-sha256.txt"}
            assert named <= tree(out).keys(), f"{what}: a manifest of files that are not there"
        if finish:
            again = server.release(out)
            assert again.status == 0, f"{what}: {again.err}"
            assert tree(out) == whole.tree, what

    return checked


def _said(outcome, what: object) -> None:
    """That a command which a fault ended said so as documented, in one line."""
    assert outcome.status in DOCUMENTED, f"{what}: exit code {outcome.status}: {outcome.err}"
    assert "Traceback" not in outcome.err, what
    assert sum(line.startswith("symolo: ") for line in outcome.err.splitlines()) == 1, f"{what}: {outcome.err}"


@pytest.mark.parametrize("kills", [1, _full(1000)])
def test_killed_at_random_instants_it_ends_with_the_same_tree(kills, server, whole, check, tmp_path):
    instants = np.random.Generator(np.random.PCG64(6))
    killed = 0
    while killed < kills:
        out = tmp_path / f"after_{killed}"
        # Some are killed until they come to their end, the others are begun again after one kill.
        while killed < kills:
            done = server.release(out, kill_after_s=float(instants.uniform(0, whole.seconds)))
            assert done.status in {0, -9}, done.err
            killed += done.status == -9
            check(out, f"kill {killed}", finish=False)
            if done.status == 0 or instants.uniform() < 0.2:
                break
        check(out, f"kill {killed}")
        shutil.rmtree(out)


@pytest.mark.parametrize("number", [signal.SIGTERM, _full(signal.SIGINT)])
def test_an_interrupt_stops_at_once_and_says_how_to_go_on(number, server, whole, check, tmp_path):
    at = len(whole.operations) // 2
    done = server.release(tmp_path / "data", root=str(tmp_path), at=at, error=-number)
    assert done.status == 130, done.err
    assert done.err.splitlines()[-1] == ("symolo: interrupted, nothing is lost; run the same command again to continue")
    assert "Traceback" not in done.err
    check(tmp_path / "data", number.name, finish=False)


def test_with_a_file_operation_failing(server, whole, check, tmp_path):
    """A kill half-way through a write, and a disk that is full just before the last file of all."""
    writes = [at for at, (name, _) in enumerate(whole.operations, 1) if name == "write"]
    _with_a_fault(writes[len(writes) // 2], KILL, server, whole, check, tmp_path)
    _with_a_fault(writes[-1], errno.ENOSPC, server, whole, check, tmp_path)


@pytest.mark.faults
@pytest.mark.parametrize("error", [KILL, *ERRORS], ids=["kill", *(errno.errorcode[error] for error in ERRORS)])
def test_with_every_file_operation_failing_in_its_turn(error, server, whole, check, tmp_path):
    for at in range(1, len(whole.operations) + 1):
        _with_a_fault(at, error, server, whole, check, tmp_path)


def _with_a_fault(at: int, error: int, server, whole, check, tmp_path) -> None:
    out = tmp_path / f"{at}_{error}"
    done = server.release(out, root=str(tmp_path), at=at, error=error)
    what = f"operation {at} of {len(whole.operations)}, {whole.operations[at - 1]}, {error}"
    if error == KILL:
        assert done.status == -9, what
    elif done.status != 0:  # 0 where what failed is tried in another way
        _said(done, what)
    check(out, what)
    shutil.rmtree(out)


def test_with_a_quota_that_is_used_up_it_says_so_and_ends_with_the_same_tree(server, whole, check, tmp_path):
    writes = [at for at, (name, _) in enumerate(whole.operations, 1) if name == "write"]
    done = server.release(tmp_path / "data", root=str(tmp_path), at=writes[len(writes) // 3], error=errno.EDQUOT)
    assert done.status == 5, done.err
    assert re.search(
        r"^symolo: \[Errno 122\] Disk quota exceeded: '.*'; remove files of yours on that disk or get a larger quota,"
        r" and run the same command again$",
        done.err,
        re.MULTILINE,
    )
    check(tmp_path / "data", "quota")


@pytest.mark.parametrize("number_of_limits", [2, _full(60)])
def test_with_a_limit_on_the_size_of_files_it_says_so_and_ends_with_the_same_tree(
    number_of_limits, server, whole, check, tmp_path
):
    """Python ignores the signal that comes with it. Smaller ones than these stop the engine's own files as well."""
    for limit in np.geomspace(3000, 0.9 * max(whole.sizes), number_of_limits).astype(int).tolist():
        out = tmp_path / f"limit_{limit}"
        done = server.release(out, file_bytes=limit)
        assert done.status == 5, f"{limit} bytes: {done.err}"
        _said(done, limit)
        assert "File too large: '" in done.err
        assert "; raise the limit on the size of files, such as by `ulimit -f unlimited`, and" in done.err
        check(out, f"{limit} bytes")


@pytest.mark.faults
def test_on_a_disk_of_any_size_it_ends_whole_or_says_that_there_is_no_room(server, whole, check, disk):
    """The largest of the sizes hold the release."""
    sizes = 200
    pages = 40 + sum(-(-size // 4096) + 1 for size in whole.sizes)
    filled = 0
    for number, size in enumerate(np.linspace(12, 1.6 * pages, sizes).astype(int).tolist()):
        out = disk.folder / f"data_{number}"
        disk.leave(size)
        done = server.release(out, any_disk=True)
        if done.status != 0:
            _said(done, f"{size} pages")
            assert "space" in done.err, done.err
            filled += 1
        check(out, f"{size} pages", finish=False)
        disk.enlarge()
        check(out, f"{size} pages")
        shutil.rmtree(out)
    assert 0 < filled < sizes


@pytest.mark.faults
def test_units_in_any_order_give_the_same_tree(server, whole, tree, tmp_path):
    for seed in range(20):
        out = tmp_path / f"order_{seed}"
        assert server.release(out, shuffle=seed, workers=4).status == 0
        assert tree(out) == whole.tree


def test_every_rename_is_of_what_is_on_the_disk_and_is_itself_put_there(whole):
    """A file is synced after its last write and before it gets its name, and the folder that names it afterwards.

    What goes wrong without: T. S. Pillai et al., All File Systems Are Not Created Equal: On the Complexity of Crafting
    Crash-Consistent Applications, OSDI 2014.
    """
    unsynced: set[str] = set()
    unnamed: dict[str, str] = {}
    renames = 0
    for name, path in whole.operations:
        if name == "write":
            unsynced.add(path)
        elif name == "fsync":
            unsynced.discard(path)
            for renamed in [of for of, folder in unnamed.items() if folder == path]:
                del unnamed[renamed]
        elif name in {"rename", "replace"}:
            old, new = path.split(" ")
            assert old not in unsynced, f"{new} is named before it is on the disk"
            unnamed[new] = str(Path(new).parent)
            renames += 1
        elif name == "unlink":
            unsynced.discard(path)
    assert renames > 20
    assert unsynced == set()
    assert unnamed == {}

"""The power fails while a command works: the same command again ends with the same bytes.

What the command changes is recorded, replayed on a model of a disk, and cut after every operation; what had not been
flushed is lost, torn or out of order. Each of these disks is then laid down, looked at as a reader would, and the
command is run on it again. The full form has the marker `faults`.
"""

import dataclasses
import re
import shutil
from collections.abc import Callable
from pathlib import Path, PurePosixPath

import numpy as np
import pytest

from symolo.core.files.file_locks import LOCK
from tests.faults.disk_model import Cut, Disk, Tree, cuts, lost, tree_below, write_tree

FORMATS = "tum,kitti,webdataset"
REFUSED = 2
"""Exit code for a place that is taken."""
UNFINISHED = re.compile(r"(^|/)\.[^/]+\.(tmp|dropped|partial|download)(/|$)")
"""Names under which something may lie unfinished."""
JOURNAL = re.compile(r"\.stages/.*\.jsonl$")
"""A journal: it grows with each attempt, so it differs after an interruption."""


@dataclasses.dataclass(frozen=True)
class Command:
    """A command that changes the folder `out` on the disk."""

    name: str
    prepare: Callable[[Path, Path], None]
    """Lays down what is at `out` before the command, given a release beside it."""
    arguments: Callable[[Path, Path], list[str]]
    """Of the command line, given the release and `out`."""
    whole_at_once: bool = False
    """Whether `out` must be empty before and then appears with all its files."""


def _nothing(_release: Path, _out: Path) -> None:
    pass


def _damaged_release(release: Path, out: Path) -> None:
    """With faults of every kind that a repair treats in its own way: see `pipeline.repair.repair`."""
    shutil.copytree(release, out, ignore=shutil.ignore_patterns("*.jsonl"))
    run = out / "CW/test_1"
    one, two = (run / "images/000001.jpg", out / "metadata.json")
    first, second = one.read_bytes(), two.read_bytes()
    one.write_bytes(second)
    two.write_bytes(first)
    (run / "images/000002.jpg").write_bytes(b"")
    (run / "data.csv").rename(run / "moved.csv")
    (run / "side/spec.json").unlink()
    (out / "README.md").unlink()
    (out / "README.md").mkdir()
    flipped = bytearray((out / "manifest-sha256.txt").read_bytes())
    flipped[3] ^= 1
    (out / "manifest-sha256.txt").write_bytes(flipped)


def _damaged_without_stages(release: Path, out: Path) -> None:
    _damaged_release(release, out)
    shutil.rmtree(out / ".stages")
    (out / "CW/test_1/moved.csv").unlink()


def _outdated(release: Path, out: Path) -> None:
    """A run that was changed, one that the scenario no longer has, a damaged image, and what a killed command left."""
    shutil.copytree(release, out)
    (out / ".README.md.0123456789abcdef.tmp").write_bytes(b"# ")
    (out / "CW/test_1/data.csv").write_bytes(b"changed")
    (out / ".stages/render/CW/test_1/images/000002.jpg").write_bytes(b"changed")
    shutil.copytree(out / "CW/test_1", out / "CCW/test_2")
    shutil.copytree(out / ".stages/assemble/CW/test_1", out / ".stages/assemble/CCW/test_2")


def _release(_source: Path, out: Path) -> list[str]:
    return ["release", str(Path(__file__).with_name("bare.yaml")), "--out", str(out), "--workers", "1"]


def _release_over(source: Path, out: Path) -> list[str]:
    return [*_release(source, out), "--replace"]


def _repair(_source: Path, out: Path) -> list[str]:
    return ["repair", str(out), "--workers", "1"]


def _export(release: Path, out: Path) -> list[str]:
    return ["export", str(release), "--format", FORMATS, "--out", str(out)]


def _download(release: Path, out: Path) -> list[str]:
    return ["download", f"file://{release}", "--out", str(out)]


COMMANDS = (
    Command("release", _nothing, _release),
    Command("release over another", _outdated, _release_over),
    Command("repair", _damaged_release, _repair),
    Command("repair without stages", _damaged_without_stages, _repair),
    Command("export", _nothing, _export, whole_at_once=True),
    Command("download", _nothing, _download, whole_at_once=True),
)


@dataclasses.dataclass(frozen=True)
class Record:
    """A command that nothing disturbed, and what it did to the disk."""

    arguments: list[str]
    disk: Path
    before: Tree
    after: Tree
    operations: list


@pytest.fixture(scope="module")
def source(server, tmp_path_factory) -> Path:
    """A finished release."""
    out = tmp_path_factory.mktemp("source") / "data"
    done = server.release(out)
    assert done.status == 0, done.err
    return out


@pytest.fixture(scope="module", params=COMMANDS, ids=[command.name for command in COMMANDS])
def command(request) -> Command:
    return request.param


@pytest.fixture(scope="module")
def record(command, server, source, tmp_path_factory) -> Record:
    disk = tmp_path_factory.mktemp("power") / "disk"
    disk.mkdir()
    command.prepare(source, disk / "data")
    return _recorded(command.arguments(source, disk / "data"), disk, server)


def _recorded(arguments: list[str], disk: Path, server, status: int = 0, what: str = "") -> Record:
    before = tree_below(disk)
    done = server.release(disk, arguments=arguments, root=str(disk.parent), recorded=True)
    assert done.status == status, f"{what}: {done.err}"
    return Record(arguments, disk, before, tree_below(disk), done.operations)


def _kept(tree: Tree) -> Tree:
    """What has to be the same after every interruption."""
    return {
        path: content
        for path, content in tree.items()
        if not JOURNAL.search(path) and PurePosixPath(path).name != LOCK  # which is empty, and made where one is needed
    }


def _released(tree: Tree) -> Tree:
    """The files of `out` but for the hidden stages."""
    return {
        path: content
        for path, content in tree.items()
        if path.startswith("data/") and not path.startswith("data/.stages") and content is not None
    }


def test_the_record_of_the_operations_holds_every_byte_and_all_is_flushed_in_the_end(record):
    disk = Disk(str(record.disk), record.before)
    for operation in record.operations:
        disk.do(operation)
    assert disk.seen() == record.after
    flushed = disk.after_power_loss([False] * disk.unflushed_namings, lost, np.random.default_rng(0))
    assert _kept(flushed) == _kept(record.after)


@pytest.mark.parametrize(("most", "twice"), [(3, 0), pytest.param(None, 10, marks=pytest.mark.faults)])
def test_the_same_command_after_a_loss_of_power_ends_with_the_same_bytes(most, twice, command, record, server, report):
    """After every `twice`-th loss, the power fails a second time while the command makes up for it."""
    rng = np.random.Generator(np.random.PCG64(3))
    chosen = list(cuts(str(record.disk), record.before, record.operations, 7))
    if most:
        chosen = [chosen[place] for place in sorted(rng.choice(len(chosen), most, replace=False))]
    second, wrong = 0, []
    for number, cut in enumerate(chosen):
        try:
            again = _check(cut, command, record, server)
            if twice and number % twice == 0:
                later = list(cuts(str(record.disk), cut.tree, again.operations, 8))
                after_one = dataclasses.replace(record, before=cut.tree)
                _check(later[int(rng.integers(len(later)))], command, after_one, server)
                second += 1
        except AssertionError as error:
            wrong.append(str(error)[:2000])
    if twice:
        report(f"{command.name}: {len(record.operations)} operations, {len(chosen)} cuts, {second} second ones")
    assert not wrong, "\n\n".join(wrong)


@pytest.fixture
def report(capsys):
    """Prints a line that is seen although the test passes."""

    def printed(line: str) -> None:
        with capsys.disabled():
            print(f"\n{line}", end="")  # noqa: T201 - the figure that the full form is run for

    return printed


def _check(cut: Cut, command: Command, record: Record, server) -> Record:
    """Lay down the disk, look at it, run the command again and compare; what the command did then."""
    shutil.rmtree(record.disk)
    record.disk.mkdir()
    write_tree(cut.tree, record.disk)
    _check_what_is_seen(cut, command, record, server)
    complete = command.whole_at_once and _released(cut.tree) == _released(record.after)
    again = _recorded(record.arguments, record.disk, server, REFUSED if complete else 0, cut.what)
    assert _kept(again.after) == _kept(record.after), cut.what
    return again


def _check_what_is_seen(cut: Cut, command: Command, record: Record, server) -> None:
    """No reader takes for whole what is not."""
    whole = _released(record.after)
    for path, content in _released(cut.tree).items():
        if not UNFINISHED.search(path):
            assert content in {record.before.get(path), whole.get(path)}, f"{cut.what}: {path}"
    if command.whole_at_once:
        assert _released(cut.tree) in ({}, whole), cut.what
    elif "data" in cut.tree and _released(cut.tree) != whole:
        verified = server.release(record.disk, arguments=["verify", str(record.disk / "data")])
        assert verified.status != 0, f"{cut.what}: {verified.err}"

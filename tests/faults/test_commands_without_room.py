"""Every other command that writes, with no room for what it writes: one line, exit code 5, and it can be given again.

Room is lacking in four ways: a quota that is used up at one file operation, a disk that is really full, a limit on the
size of files, and too little memory. `test_release_under_faults.py` has `release` and its stages.
"""

import errno
import inspect
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from pipeline.cli import NAMES, PANELS

SHORTEST_BYTES = 1000
"""Least limit on the size of files, with which messages can still be written to a file."""
OPERATIONS = {"write", "create", "mkdir", "rename", "replace", "fsync"}
MANY = 40
"""Operations that fail of a command that takes seconds; of the others all."""
TESTS = Path(__file__).parents[1]
RELEASE, OUT = "RELEASE", "OUT"
ABOUT = """\
title: A robot
authors: [{family: Lovelace, given: Ada}]
published: "2026-11-23"
publisher: Zenodo
"""
FORMATS = (
    "tum",
    "kitti",
    "coco",
    "yolo",
    "webdataset",
    "parquet",
    "mcap",
    "ros1",
    "hdf5",
    "huggingface",
    "lerobot",
    "rerun",
)


@dataclass(frozen=True)
class Command:
    """One that writes; RELEASE and OUT stand for a release and a place that is free."""

    arguments: tuple[str, ...]
    is_slow: bool = False
    leaves_parts: bool = False
    """Whether a file that is whole may be there without the others; else there is all or nothing."""
    is_in_place: bool = False
    """Whether OUT is a copy of the release that it changes."""
    missing: str = ""
    """File that the copy lacks."""


KEY = str(TESTS / "symolo/signing/made_by_minisign/plain.key")
RUN = f"{RELEASE}/CW/test_1"
LOG = str(TESTS / "faults/poses.csv")
LOOK = str(TESTS / "faults/bare_look.yaml")
COMMANDS = {
    "bag": Command(("bag", RELEASE, "--out", OUT)),
    "download": Command(("download", f"file://{RELEASE}", "--out", OUT)),
    "upload": Command(("upload", RELEASE, f"file://{OUT}"), leaves_parts=True),
    "pack": Command(("pack", RELEASE, "--about", "FACTS", "--out", OUT)),
    "report": Command(("report", RELEASE, "--out", f"{OUT}.html"), is_slow=True),
    "view": Command(("view", RELEASE, "--out", f"{OUT}.html")),
    "video": Command(("video", RELEASE, "--out", f"{OUT}.mp4", "--width-px", "320", "--fps", "2"), is_slow=True),
    "contact-sheet": Command(("contact-sheet", RELEASE, "--out", f"{OUT}.jpg")),
    "preview": Command(
        ("preview", "smoke", "--engine", "flat", "-n", "1", "--width-px", "32", "--out", f"{OUT}.jpg"), is_slow=True
    ),
    "firmware": Command(("firmware", "--out", OUT)),
    "model": Command(("model", "smoke", "--out", OUT)),
    "sign": Command(
        ("sign", OUT, "--key", KEY, "--time", "2026-11-23T16:00:00Z", "--provenance"),
        leaves_parts=True,
        is_in_place=True,
    ),
    "repair": Command(("repair", OUT), leaves_parts=True, is_in_place=True, missing="CW/test_1/data.csv"),
    "baselines": Command(("baselines", RELEASE, "--methods", "odometry", "--out", OUT), is_slow=True),
    "rerender": Command(
        ("rerender", RUN, "--look", LOOK, "--set", "render.annotations=[]", "--workers", "1", "--out", OUT),
        leaves_parts=True,
    ),
    "import": Command(("import", LOG, "--yes", "--out", OUT), leaves_parts=True),
    "diagnose": Command(("diagnose", "table-1", "--workers", "1", "--out", OUT), is_slow=True, leaves_parts=True),
    "validate": Command(("validate", "line-sensor", "--out", OUT), is_slow=True, leaves_parts=True),
    **{f"export {name}": Command(("export", RELEASE, "--format", name, "--out", OUT)) for name in FORMATS},
}
SHORT = ("bag", "contact-sheet")
ELSEWHERE = {
    **dict.fromkeys(("release", "simulate", "render", "assemble"), "test_release_under_faults.py"),
    "hil": "a release, but for the drive",
    "identify-camera": "writes as `validate` does",
    "next": "writes a new folder as `model` does",
    "train": "needs PyTorch; writes one file as `contact-sheet` does",
}


def test_every_command_that_writes_is_here_or_elsewhere():
    commands = [command for panel in PANELS.values() for command in panel]
    writers = [command for command in commands if "out" in inspect.signature(command).parameters]
    writing = {NAMES.get(command, command.__name__.replace("_", "-")) for command in writers}
    assert {name.split()[0] for name in COMMANDS} | ELSEWHERE.keys() >= writing


@pytest.fixture
def trial(server, tree, tmp_path):
    return lambda name: Trial(name, server, tree, tmp_path)


class Trial:
    """A command given under one fault after the other, each time in a folder as it was before."""

    def __init__(self, name: str, server, tree: Callable, folder: Path) -> None:
        self.command, self.name, self._server, self._tree, self._folder = COMMANDS[name], name, server, tree, folder
        self.work = folder / "work"
        shutil.copytree(TESTS / "fuzz/corpus/dataset/valid", folder / "release")
        (folder / "about.yaml").write_text(ABOUT)
        self.begin()
        self.undisturbed = self.give(root=str(self.work))
        assert self.undisturbed.status == 0, self.undisturbed.err
        self.whole = self.shown()
        assert self.whole

    def begin(self) -> None:
        """Make the folder as it is before the command."""
        self.work.mkdir(exist_ok=True)
        for path in self.work.iterdir():
            shutil.rmtree(path) if path.is_dir() else path.unlink()
        if self.command.is_in_place:
            shutil.copytree(self._folder / "release", self.work / "out")
            if self.command.missing:
                (self.work / "out" / self.command.missing).unlink()
        (self.work / "tmp").mkdir()

    def give(self, **order):
        places = {RELEASE: self._folder / "release", OUT: self.work / "out", "FACTS": self._folder / "about.yaml"}
        arguments = list(self.command.arguments)
        for name, place in places.items():
            arguments = [argument.replace(name, str(place)) for argument in arguments]
        return self._server.release(self.work, arguments=arguments, scratch=str(self.work / "tmp"), **order)

    def shown(self) -> dict[str, str]:
        """Return what the folder shows by names that count."""
        files = self._tree(self.work).items()
        return {path: digest for path, digest in files if not path.startswith((".", "tmp/")) and "/." not in path}

    def check(self, ended, what: object, named: str) -> None:
        """Check what a command under a fault left, and that its message names what is lacking."""
        what = f"{self.name}, {what}: exit code {ended.status}: {ended.err}"
        there = self.shown()
        assert there.items() <= self.whole.items(), what
        if ended.status == 0:  # what failed was not needed, such as a folder that is there already
            assert there == self.whole, what
            return
        messages = [line for line in ended.err.splitlines() if line.startswith("symolo: ")]
        assert (ended.status, len(messages), "Traceback" in ended.err) == (5, 1, False), what
        assert named in messages[0], what
        if not self.command.leaves_parts:
            assert there in ({}, self.whole), what

    def complete(self, what: object) -> None:
        """Give the command again without the fault."""
        there = self.shown()
        again = self.give()
        assert again.status == 0 or (there == self.whole and "is there already" in again.err), f"{what}: {again.err}"
        assert self.shown() == self.whole, what
        assert list((self.work / "tmp").iterdir()) == [], what


@pytest.mark.parametrize(
    "name", [name if name in SHORT else pytest.param(name, marks=pytest.mark.faults) for name in COMMANDS]
)
def test_a_quota_that_is_used_up_in_the_middle(name, trial):
    under_quota(trial(name), lambda steps: steps[len(steps) // 2 : len(steps) // 2 + 1])


@pytest.mark.faults
@pytest.mark.parametrize("name", COMMANDS)
def test_a_quota_that_is_used_up_at_any_file_operation(name, trial):
    under_quota(trial(name), lambda steps: steps[:: 1 + len(steps) // MANY] if COMMANDS[name].is_slow else steps)


def under_quota(trial: Trial, chosen: Callable[[list[int]], list[int]]) -> None:
    operations = trial.undisturbed.operations
    for at in chosen([at for at, (kind, _) in enumerate(operations, 1) if kind in OPERATIONS]):
        trial.begin()
        ended = trial.give(root=str(trial.work), at=at, error=errno.EDQUOT)
        trial.check(ended, operations[at - 1], "quota")
        trial.complete(operations[at - 1])


@pytest.mark.faults
@pytest.mark.parametrize("name", COMMANDS)
def test_a_disk_of_any_size(name, disk, trial):
    """Its files and temporary files are on that disk; the largest has room for all. Only root can mount one."""
    tried = trial(name)
    needed = 4 * sum(-(-path.stat().st_size // 4096) + 1 for path in tried.work.rglob("*"))
    statuses = set()
    for pages in np.unique(np.linspace(0, needed, 6 if tried.command.is_slow else 20).astype(int)).tolist():
        disk.enlarge()
        tried.begin()
        disk.leave(pages)
        ended = tried.give(any_disk=True)
        tried.check(ended, f"{pages} pages", "space")
        statuses.add(ended.status)
        disk.enlarge()
        tried.complete(f"{pages} pages")
    assert statuses == {0, 5}


@pytest.mark.faults
@pytest.mark.parametrize("name", COMMANDS)
def test_a_limit_on_the_size_of_files(name, trial):
    tried = trial(name)
    largest = max(path.stat().st_size for path in tried.work.rglob("*") if path.is_file())
    statuses = set()
    for limit in np.geomspace(SHORTEST_BYTES, 0.9 * largest, 3 if tried.command.is_slow else 8).astype(int).tolist():
        tried.begin()
        ended = tried.give(file_bytes=limit)
        tried.check(ended, f"{limit} bytes", "ulimit -f")
        statuses.add(ended.status)
        tried.complete(f"{limit} bytes")
    assert 5 in statuses


@pytest.mark.faults
@pytest.mark.parametrize("name", COMMANDS)
def test_little_memory(name, trial):
    """From none beyond what the process has to what is enough. A library may crash; then nothing is half-written."""
    tried = trial(name)
    for size in [0, *np.geomspace(1 << 16, 1 << 30, 4 if tried.command.is_slow else 12).astype(int).tolist()]:
        tried.begin()
        ended = tried.give(address_bytes=size)
        if ended.status >= 0:
            tried.check(ended, f"{size} bytes", "memory")
        assert tried.shown().items() <= tried.whole.items(), f"{size} bytes: {ended.err}"
        tried.complete(f"{size} bytes")

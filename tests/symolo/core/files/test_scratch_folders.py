"""Scratch folders go with their process, and those of killed processes with the next command."""

import contextlib
import errno
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from symolo.core.files import file_locks, scratch_folders
from symolo.core.files.scratch_folders import scratch_folder

USES_ONE = """\
from symolo.core.files.scratch_folders import scratch_folder
with scratch_folder() as folder:
    (folder / "below").mkdir()
    (folder / "below" / "frame.exr").write_bytes(b"x")
    print(folder, flush=True)
    input()
"""


@contextlib.contextmanager
def another_process() -> Iterator[tuple[subprocess.Popen[str], Path]]:
    command = [sys.executable, "-c", USES_ONE]
    environment = {**os.environ, "TMPDIR": tempfile.gettempdir()}
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment) as child:
        assert child.stdout is not None
        try:
            yield child, Path(child.stdout.readline().strip())
        finally:
            child.kill()


@pytest.fixture(autouse=True)
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


@pytest.fixture
def left(place: Path) -> Path:
    """The folder of a process that was killed."""
    with another_process() as (child, folder):
        child.send_signal(signal.SIGKILL)
        child.wait()
    assert (folder / "below" / "frame.exr").is_file()
    assert folder.parent == place
    return folder


def test_a_folder_goes_if_there_is_no_room_for_the_file_with_its_lock(place: Path, monkeypatch: pytest.MonkeyPatch):
    def no_room(folder: Path, name: str) -> int:
        raise OSError(errno.EDQUOT, os.strerror(errno.EDQUOT), str(folder / name))

    monkeypatch.setattr(scratch_folders, "opened_lock", no_room)
    with pytest.raises(OSError, match="quota"), scratch_folder():
        pass
    assert list(place.iterdir()) == []


def test_a_folder_goes_at_the_end_of_its_block_whatever_happens(place: Path):
    with contextlib.suppress(ZeroDivisionError), scratch_folder() as folder:
        (folder / "file").write_bytes(b"x")
        assert folder.parent == place
        raise ZeroDivisionError
    assert list(place.iterdir()) == []


def test_a_folder_is_made_where_it_is_wanted(place: Path):
    (place / "cache").mkdir()
    with scratch_folder(place / "cache") as folder:
        assert folder.parent == place / "cache"


def test_the_folder_of_a_killed_process_goes_with_the_next_command(left: Path, place: Path):
    with scratch_folder():
        assert not left.exists()
    assert list(place.iterdir()) == []


def test_the_folder_of_a_living_process_stays(place: Path):
    with another_process() as (_, living), scratch_folder() as own:
        assert set(place.iterdir()) == {living, own}
        assert (living / "below" / "frame.exr").is_file()


def test_a_removal_that_was_killed_half_way_is_continued(left: Path):
    (left / "below" / "frame.exr").unlink()
    (left / "below").rmdir()
    with scratch_folder():
        assert not left.exists()


def test_folders_of_others_stay(left: Path, place: Path):
    of_another_machine = left.rename(place / "symolo-01234567-abc")
    not_locked = place / f"{left.name}x"
    not_locked.mkdir()
    (not_locked / "file").write_bytes(b"x")
    link = place / f"{left.name}y"
    link.symlink_to(of_another_machine, target_is_directory=True)
    with scratch_folder():
        assert {of_another_machine, not_locked, link} < set(place.iterdir())
    assert (of_another_machine / "below" / "frame.exr").is_file()


def test_the_folder_of_another_user_stays(left: Path, monkeypatch: pytest.MonkeyPatch):
    user = os.getuid()
    monkeypatch.setattr(os, "getuid", lambda: user + 1)
    with scratch_folder():
        assert left.is_dir()


def test_nothing_is_removed_where_a_system_has_no_locks(left: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(file_locks, "_module", lambda _: None)
    with scratch_folder() as folder:
        assert left.is_dir()
        assert folder.is_dir()
    assert not folder.exists()


def test_a_link_in_an_abandoned_folder_is_not_followed(left: Path, place: Path):
    kept = place / "kept"
    kept.mkdir()
    (kept / "file").write_bytes(b"x")
    (left / "link").symlink_to(kept, target_is_directory=True)
    with scratch_folder():
        assert not left.exists()
    assert (kept / "file").is_file()


def test_a_folder_that_another_process_removes_before_it_is_locked_is_made_again(monkeypatch: pytest.MonkeyPatch):
    made: list[Path] = []

    def removed_first(folder: Path, name: str) -> int:
        descriptor = file_locks.opened_lock(folder, name)
        made.append(folder)
        if len(made) == 1:
            scratch_folders._remove_if_abandoned(folder)
        return descriptor

    monkeypatch.setattr(scratch_folders, "opened_lock", removed_first)
    with scratch_folder() as folder:
        assert folder.is_dir()
        assert folder != made[0]
    assert not made[0].exists()


def test_who_works_in_the_folder_may_hold_it(tmp_path):
    """The stages hold the folders in which they work, also where these are scratch folders."""
    with scratch_folder(tmp_path) as folder:
        descriptor = file_locks.opened_lock(folder)
        try:
            file_locks.lock(descriptor, wait=False)
        finally:
            os.close(descriptor)

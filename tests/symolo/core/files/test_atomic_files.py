import errno
import hashlib
import os

import pytest

from symolo.core.files import atomic_files as whole_files
from symolo.core.files.atomic_files import (
    move,
    remove_folder,
    remove_left_of,
    replace_folder,
    write_chunks,
    write_file,
)
from symolo.core.os_errors import lacking


def test_a_file_written_in_chunks_is_whole_and_known_by_its_checksum(tmp_path):
    digest = write_chunks(tmp_path / "file", (bytes([i]) * 1000 for i in range(50)))
    content = (tmp_path / "file").read_bytes()
    assert content == b"".join(bytes([i]) * 1000 for i in range(50))
    assert digest == hashlib.sha256(content).hexdigest()
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_chunks_that_end_early_leave_what_was_there(tmp_path):
    (tmp_path / "file").write_bytes(b"before")

    def chunks():
        yield b"new"
        raise RuntimeError

    with pytest.raises(RuntimeError):
        write_chunks(tmp_path / "file", chunks())
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("file", b"before")]


def test_a_disk_that_does_not_give_back_what_it_took_is_found(tmp_path, monkeypatch):
    write_all = whole_files._write_all
    monkeypatch.setattr(
        whole_files, "_write_all", lambda place, data, path: write_all(place, data.replace(b"w", b"x"), path)
    )
    with pytest.raises(OSError, match="is not what was written"):
        write_chunks(tmp_path / "file", (b"ne", b"w"))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("what", ["file", "move", "folder", "removal"])
def test_a_renaming_that_the_disk_has_lost_is_a_fault_of_the_disk(what, tmp_path, monkeypatch):
    """Which a command reports in one line with exit code 5, and not as a bug when the name is missing later."""
    for name in ("new", "old"):
        (tmp_path / name).mkdir()
    (tmp_path / "source").write_bytes(b"1")
    for name in ("rename", "replace"):
        monkeypatch.setattr(os, name, lambda *_: None)
    act = {
        "file": lambda: write_file(tmp_path / "file", b"1"),
        "move": lambda: move(tmp_path / "source", tmp_path / "place"),
        "folder": lambda: replace_folder(tmp_path / "new", tmp_path / "place"),
        "removal": lambda: remove_folder(tmp_path / "old"),
    }[what]
    with pytest.raises(OSError, match="the disk has lost a renaming") as lost:
        act()
    assert "the disk reports a fault" in lacking(lost.value)
    assert {path.name for path in tmp_path.iterdir()} == {"new", "old", "source"}


def test_what_a_killed_command_left_of_a_file_is_removed_and_what_another_is_writing_stays(tmp_path):
    left = tmp_path / ".run.mp4.33402d907e2012ea.tmp"
    of_another_file = tmp_path / ".walk.mp4.33402d907e2012ea.tmp"
    for path in (left, of_another_file):
        path.write_bytes(b"half")

    def chunks():
        yield b"one"
        remove_left_of(tmp_path / "run.mp4")  # as a second command for the same file does
        yield b"two"

    write_chunks(tmp_path / "run.mp4", chunks())
    assert sorted(path.name for path in tmp_path.iterdir()) == [of_another_file.name, "run.mp4"]
    assert (tmp_path / "run.mp4").read_bytes() == b"onetwo"


@pytest.mark.parametrize("step", ["reading back", "renaming"])
def test_a_file_that_another_command_reads_back_or_renames_stays(step, tmp_path, monkeypatch):
    place = tmp_path / "run.mp4"
    read_back, replace = whole_files.sha256_of, os.replace

    def read_meanwhile(path):
        remove_left_of(place)
        return read_back(path)

    def replace_meanwhile(old, new):
        remove_left_of(place)
        replace(old, new)

    if step == "reading back":
        monkeypatch.setattr(whole_files, "sha256_of", read_meanwhile)
    else:
        monkeypatch.setattr(os, "replace", replace_meanwhile)
    write_chunks(place, (b"one", b"two"))
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("run.mp4", b"onetwo")]


@pytest.mark.parametrize("denied", ["open", "unlink"])
def test_what_another_user_left_of_a_file_stays(denied, tmp_path, monkeypatch):
    """The system refuses to open the file, or to remove it from a folder with the sticky bit."""
    left = tmp_path / ".run.mp4.33402d907e2012ea.tmp"
    left.write_bytes(b"half")

    def refuse(*_arguments, **_options):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(left))

    with monkeypatch.context() as patched:
        patched.setattr(os if denied == "open" else whole_files.Path, denied, refuse)
        remove_left_of(tmp_path / "run.mp4")
    assert left.read_bytes() == b"half"

"""A new folder that two commands write at the same moment: one of them wins whole, and the other one is refused."""

import os
from pathlib import Path

import pytest

from symolo.core.errors import InputError
from symolo.core.files import file_locks
from symolo.core.files.atomic_files import write_file
from symolo.core.files.new_folder import new_folder

WORKING = "another symolo command is working in this folder"
WRITTEN = "another command has written this folder in the meantime"


@pytest.fixture
def out(tmp_path):
    return tmp_path / "out"


def write(out, content, meanwhile=lambda: None):
    """Write a folder of two files, with something that another command does between them."""
    with new_folder(out) as folder:
        write_file(folder / "a.txt", content)
        meanwhile()
        write_file(folder / "b.txt", content)


def check_only(out, content):
    """Check that the folder has both files of one command, and that there is nothing beside it."""
    assert {path.name: path.read_bytes() for path in out.iterdir()} == {"a.txt": content, "b.txt": content}
    assert [path.name for path in out.parent.iterdir()] == ["out"]


def refused(out, content, message):
    with pytest.raises(InputError, match=message) as raised:
        write(out, content)
    assert str(raised.value).startswith(f"--out {out}: ")


def test_a_command_that_begins_while_another_one_writes_is_refused(out):
    write(out, b"first", meanwhile=lambda: refused(out, b"second", WORKING))
    check_only(out, b"first")


def test_a_command_that_begins_to_write_after_another_one_is_refused(out):
    """Both have checked the path while it was free, and the second one takes longer until it writes."""
    write(out, b"first")
    refused(out, b"second", WRITTEN)
    check_only(out, b"first")


@pytest.mark.parametrize("name", ["os.open", "lock_or_refuse"])
def test_a_command_that_is_finished_while_another_one_locks_the_folder_wins(name, out, monkeypatch):
    """The second one has made or opened the hidden folder, which the first one then moves to its place."""
    first = new_folder(out)
    folder = first.__enter__()
    for file in ("a.txt", "b.txt"):
        write_file(folder / file, b"first")
    owner, function = (os, "open") if name == "os.open" else (file_locks, name)
    real = getattr(owner, function)

    def after_the_first(*arguments, **options):
        if name != "os.open" or Path(arguments[0]) == folder:
            monkeypatch.undo()
            first.__exit__(None, None, None)
        return real(*arguments, **options)

    monkeypatch.setattr(owner, function, after_the_first)
    refused(out, b"second", WORKING)
    check_only(out, b"first")


def test_what_another_program_writes_at_the_last_moment_stays(out, monkeypatch):
    rename = os.rename

    def rename_too_late(old, new):
        monkeypatch.undo()
        out.mkdir()
        (out / "a.txt").write_bytes(b"other")
        (out / "b.txt").write_bytes(b"other")
        rename(old, new)

    monkeypatch.setattr(os, "rename", rename_too_late)
    refused(out, b"ours", WRITTEN)
    check_only(out, b"other")


def test_an_empty_folder_is_filled_and_what_a_killed_command_left_goes(out, tmp_path):
    out.mkdir()
    left = tmp_path / ".out.partial"
    (left / "images").mkdir(parents=True)
    (left / "images/000001.jpg").write_bytes(b"half")
    (left / "link").symlink_to(tmp_path)
    write(out, b"whole")
    check_only(out, b"whole")


def test_nothing_is_written_behind_a_link_in_place_of_the_hidden_folder(out, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "kept.txt").write_bytes(b"kept")
    (tmp_path / ".out.partial").symlink_to(elsewhere)
    write(out, b"whole")
    assert [path.name for path in elsewhere.iterdir()] == ["kept.txt"]
    assert not out.is_symlink()


def test_an_exception_leaves_nothing(out, tmp_path):
    def fail():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write(out, b"half", meanwhile=fail)
    assert list(tmp_path.iterdir()) == []

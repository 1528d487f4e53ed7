"""Locks of folders that several machines share: what a network file system passes on, by flock(2)."""

import fcntl
import os
import stat

import pytest

from pipeline.cli import main
from pipeline.run_folder.workspace import Workspace
from symolo.core.errors import InputError
from symolo.core.files.file_locks import locked


@pytest.fixture
def locks_seen(monkeypatch):
    """Kind and mode of everything that is locked."""
    seen = []
    flock = fcntl.flock

    def noted(descriptor, operation):
        seen.append((stat.S_IFMT(os.fstat(descriptor).st_mode), fcntl.fcntl(descriptor, fcntl.F_GETFL) & os.O_ACCMODE))
        flock(descriptor, operation)

    monkeypatch.setattr(fcntl, "flock", noted)
    return seen


@pytest.mark.parametrize("alone", [True, False])
def test_a_workspace_is_locked_by_a_file_open_for_writing(tmp_path, locks_seen, alone):
    with Workspace(tmp_path).locked(alone=alone):
        pass
    assert set(locks_seen) == {(stat.S_IFREG, os.O_RDWR)}


def test_a_folder_of_runs_is_locked_by_a_file_open_for_writing(tmp_path, locks_seen):
    with locked(tmp_path):
        pass
    assert locks_seen == [(stat.S_IFREG, os.O_RDWR)]


def test_a_second_command_is_refused_and_parts_are_not(tmp_path):
    workspace = Workspace(tmp_path)
    refused = pytest.raises(InputError, match="another symolo command")
    with workspace.locked(alone=False), workspace.locked(alone=False), refused, workspace.locked():
        pass
    with workspace.locked():
        pass


def test_verify_checks_nothing_while_another_command_works_in_the_folder(tmp_path, capsys):
    with Workspace(tmp_path).locked():
        assert main(["verify", str(tmp_path)]) == 2
    ended = capsys.readouterr()
    assert ended.out == ""
    assert "another symolo command is working in this folder; verify it when that command has ended" in ended.err
    assert main(["verify", str(tmp_path)]) == 2
    assert "the release is not finished" in capsys.readouterr().err

"""The list of a folder's files is whole or an error."""

import errno
import hashlib
import os
from pathlib import Path

import pytest

from symolo.core.files.file_hashes import hashes_of, sizes_below


def test_every_file_is_listed_but_those_to_skip(tmp_path):
    (tmp_path / "a/b").mkdir(parents=True)
    (tmp_path / "a/b/c").write_bytes(b"c")
    (tmp_path / "done.json").write_bytes(b"d")
    assert hashes_of(tmp_path, skip=("done.json",)) == {"a/b/c": hashlib.sha256(b"c").hexdigest()}


@pytest.mark.parametrize("number", [errno.EACCES, errno.EMFILE, errno.EIO])
def test_a_folder_that_cannot_be_read_is_not_passed_over(tmp_path, monkeypatch, number):
    (tmp_path / "images").mkdir()
    (tmp_path / "images/000001.jpg").write_bytes(b"x")
    scandir = os.scandir

    def refused(path):
        if os.fspath(path).endswith("images"):
            raise OSError(number, os.strerror(number))
        return scandir(path)

    monkeypatch.setattr(os, "scandir", refused)
    with pytest.raises(OSError, match=os.strerror(number)):
        hashes_of(tmp_path)


def test_of_the_sizes_below_what_has_gone_since_its_folder_was_read_is_no_file(tmp_path, monkeypatch):
    """As a scratch file does that gets its name while another command counts."""
    (tmp_path / "a").mkdir()
    (tmp_path / "a/data.csv").write_bytes(b"abc")
    (tmp_path / "a/scratch").write_bytes(b"ab")
    lstat = Path.lstat

    def late(path):
        (tmp_path / "a/scratch").unlink(missing_ok=True)
        return lstat(path)

    monkeypatch.setattr(Path, "lstat", late)
    assert dict(sizes_below(tmp_path)) == {tmp_path / "a/data.csv": 3}

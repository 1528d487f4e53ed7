"""The list of a folder's files is whole or an error."""

import errno
import hashlib
import os

import pytest

from pipeline.files import hashes_of


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

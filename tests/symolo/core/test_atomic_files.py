import hashlib

import pytest

from symolo.core.files import atomic_files as whole_files
from symolo.core.files.atomic_files import write_chunks


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
    monkeypatch.setattr(whole_files, "_write_all", lambda place, data: write_all(place, data.replace(b"w", b"x")))
    with pytest.raises(OSError, match="is not what was written"):
        write_chunks(tmp_path / "file", (b"ne", b"w"))
    assert not list(tmp_path.iterdir())

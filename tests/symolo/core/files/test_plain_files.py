"""A file of a dataset is read if it is a plain file of a usual size, and refused at once otherwise."""

import os
import pickle
import shutil
import socket
import tempfile
from pathlib import Path

import pytest

from symolo.core.errors import InputError
from symolo.core.files import plain_files
from symolo.core.files.plain_files import (
    FileKind,
    UnsafeFileError,
    check_folders,
    check_tree,
    is_plain_file,
    open_file,
    read_file,
    read_named_file,
)


def make_socket(path):
    with tempfile.TemporaryDirectory() as short:  # the name of a socket has at most 107 characters
        with socket.socket(socket.AF_UNIX) as server:
            server.bind(f"{short}/s")
        shutil.move(f"{short}/s", path)


STRANGE = {
    "a symbolic link": lambda path: path.symlink_to("/etc/passwd"),
    "a symbolic link ": lambda path: path.symlink_to("/dev/zero"),
    "a symbolic link  ": lambda path: path.symlink_to(path),
    "a pipe": os.mkfifo,
    "a socket": make_socket,
    "a folder": Path.mkdir,
}


@pytest.fixture(params=STRANGE)
def strange(request, tmp_path):
    path = tmp_path / "metadata.json"
    STRANGE[request.param](path)
    return path, request.param.strip()


def test_a_plain_file_is_read(tmp_path):
    path = tmp_path / "data.csv"
    for data in (b"", b"a", bytes(range(256)) * 5000):
        path.write_bytes(data)
        assert read_file(path, FileKind.DOCUMENT) == read_named_file(path, FileKind.DOCUMENT) == data
        with open_file(path) as file:
            assert file.read() == data
    assert is_plain_file(path)


def test_what_is_no_plain_file_is_refused_with_what_it_is(strange):
    path, what = strange
    for read in (lambda: read_file(path, FileKind.DOCUMENT), lambda: open_file(path)):
        with pytest.raises(UnsafeFileError) as refusal:
            read()
        assert str(refusal.value).startswith(f"{path}: is {what}, and a dataset holds plain files; put the file itself")
        assert refusal.value.strerror == f"it is {what}, and a dataset holds plain files"
    assert not is_plain_file(path)


def test_a_refusal_comes_out_of_a_worker_process_unchanged(strange):
    with pytest.raises(UnsafeFileError) as refusal:
        read_file(strange[0], FileKind.DOCUMENT)
    again = pickle.loads(pickle.dumps(refusal.value))  # noqa: S301 - our own bytes
    assert (str(again), again.problem, again.filename) == (str(refusal.value), refusal.value.problem, str(strange[0]))


@pytest.mark.parametrize("device", ["/dev/zero", "/dev/null", "/dev/tty"])
def test_a_device_is_refused(device):
    with pytest.raises(UnsafeFileError, match=f"^{device}: is a device"):
        read_file(Path(device), FileKind.DOCUMENT)


def test_a_refusal_is_an_error_of_the_input_and_of_the_system(strange):
    with pytest.raises(InputError):
        read_file(strange[0], FileKind.DOCUMENT)
    with pytest.raises(OSError, match="plain files"):
        read_file(strange[0], FileKind.DOCUMENT)


def test_a_file_that_is_larger_than_its_kind_is_not_read(tmp_path):
    path = tmp_path / "metadata.json"
    path.write_bytes(b"secret")
    os.truncate(path, 1 << 40)  # of which the disk holds nothing
    for kind in FileKind:
        with pytest.raises(UnsafeFileError, match=rf"is larger than \d+ MiB, which {kind.title} never is") as refusal:
            read_file(path, kind)
        assert "secret" not in str(refusal.value)


def test_a_missing_file_is_the_error_of_the_system(tmp_path):
    with pytest.raises(FileNotFoundError):
        read_file(tmp_path / "none", FileKind.DOCUMENT)
    assert not is_plain_file(tmp_path / "none")
    assert not is_plain_file(tmp_path / "a\0b")


def test_a_file_that_the_user_names_may_be_a_link_but_no_device(tmp_path):
    (tmp_path / "log.csv").write_bytes(b"t\n")
    (tmp_path / "link").symlink_to("log.csv")
    assert read_named_file(tmp_path / "link", FileKind.DOCUMENT) == b"t\n"
    (tmp_path / "zero").symlink_to("/dev/zero")
    with pytest.raises(UnsafeFileError, match="is a device"):
        read_named_file(tmp_path / "zero", FileKind.DOCUMENT)
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(UnsafeFileError, match="is a pipe"):
        read_named_file(tmp_path / "pipe", FileKind.DOCUMENT)


def test_a_system_without_the_flags_reads_and_refuses_the_same(strange, tmp_path, monkeypatch):
    """As on Windows: what is there is looked at before it is opened."""
    monkeypatch.setattr(plain_files, "_NO_LINK", 0)
    monkeypatch.setattr(plain_files, "_FLAGS", os.O_RDONLY)
    with pytest.raises(UnsafeFileError):
        read_file(strange[0], FileKind.DOCUMENT)
    (tmp_path / "plain").write_bytes(b"1")
    assert read_file(tmp_path / "plain", FileKind.DOCUMENT) == b"1"


def test_no_descriptor_stays_open(strange, tmp_path):
    (tmp_path / "plain").write_bytes(b"1")
    before = len(list(Path("/proc/self/fd").iterdir()))
    for _ in range(5):
        read_file(tmp_path / "plain", FileKind.DOCUMENT)
        with pytest.raises(UnsafeFileError):
            read_file(strange[0], FileKind.DOCUMENT)
    assert len(list(Path("/proc/self/fd").iterdir())) == before


def test_a_linked_folder_is_refused_on_the_way_to_a_run_and_in_it_but_not_above_the_dataset(tmp_path):
    real = tmp_path / "real/data"
    (real / "CW/test_1/images").mkdir(parents=True)
    (real / "CW/test_1/annotations/depth").mkdir(parents=True)
    (tmp_path / "link").symlink_to("real")
    root = tmp_path / "link/data"
    check_folders(root, "CW/test_1")
    check_folders(root / "CW/test_1", "")
    (real / "CCW").symlink_to("CW")
    with pytest.raises(UnsafeFileError, match=f"^{root}/CCW: is a symbolic link, and a dataset holds plain folders"):
        check_folders(root, "CCW/test_1")
    for name in ("images", "annotations/depth"):
        folder = real / "CW/test_1" / name
        folder.rmdir()
        folder.symlink_to("/etc")
        for run in ((root, "CW/test_1"), (root / "CW/test_1", "")):
            with pytest.raises(UnsafeFileError, match=f"^{root}/CW/test_1/{name}: is a symbolic link"):
                check_folders(*run)
        folder.unlink()
        folder.mkdir()


@pytest.mark.parametrize("name", [".stages", ".stages/simulate", ".stages/simulate/CW/test_1", ".stages/render/CW/a/b"])
def test_a_tree_with_a_linked_folder_at_any_depth_is_refused(tmp_path, name):
    check_tree(tmp_path / "data", ".stages")  # there is none yet
    link = tmp_path / "data" / name
    link.parent.mkdir(parents=True)
    link.symlink_to(tmp_path)
    (tmp_path / "link").symlink_to("data")
    with pytest.raises(UnsafeFileError, match=f"^{tmp_path}/link/{name}: is a symbolic link"):
        check_tree(tmp_path / "link", ".stages")
    link.unlink()
    link.mkdir()
    check_tree(tmp_path / "link", ".stages")

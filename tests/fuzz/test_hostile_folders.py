"""Bags, datasets and downloads whose names, links and sizes are those of somebody who means harm."""

import hashlib
import os
import shutil
import struct
import time
import zlib
from typing import Any

import pytest

from symolo.core.errors import InputError
from symolo.core.progress import LineReport
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST, manifest, tag_manifest
from symolo.reader.dataset import load
from symolo.storage.download import Remote, download
from symolo.storage.folder import Folder
from symolo.verification.verify import verify
from tests.fuzz.folders import valid_copy
from tests.fuzz.guard import limits
from tests.fuzz.readers import MemoryStore

EMPTY = hashlib.sha256(b"").hexdigest()
RUN = "CW/test_1"
NAMES = [
    "../beside", "a/../../beside", "/etc/passwd", "//a", "a//b", "./a", "a/.", "..", ".", "a/", "a\tb", "a\x1b[2J",
    "a\u202eb", ".stages/kind", MANIFEST, "tagmanifest-sha256.txt.minisig", "a" * 129, "\u00e9" * 65, "a/" * 40 + "b",
    "a/" * 600 + "b",
]  # fmt: skip
SECONDS = 2.0


@pytest.fixture(autouse=True)
def _limited():
    with limits():
        yield


def fetched(digests, tmp_path):
    """Download a release of empty files under these names; return what lies in the folder afterwards."""
    store: Any = MemoryStore({MANIFEST: manifest(digests), TAG_MANIFEST: tag_manifest(digests)}, tuple(digests))
    (tmp_path / "inner").mkdir()
    begin = time.process_time()
    try:
        download(Remote.from_store(store), tmp_path / "inner" / "out", LineReport())
    finally:
        assert time.process_time() - begin < SECONDS
        there = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*")}
        assert {name for name in there if not name.startswith("inner/out/")} <= {"inner", "inner/out"}


@pytest.mark.parametrize("name", NAMES)
def test_a_name_that_no_release_has_is_refused_before_anything_is_fetched(name, tmp_path):
    with pytest.raises(InputError, match=MANIFEST):
        fetched({name: EMPTY, "README.md": EMPTY}, tmp_path)
    assert not (tmp_path / "inner" / "out").exists()


def test_a_file_below_a_file_is_refused(tmp_path):
    with pytest.raises(InputError, match=MANIFEST):
        fetched({"a": EMPTY, "a/b": EMPTY}, tmp_path)


def test_names_that_release_may_have_are_fetched(tmp_path):
    fetched({"CW/test_1/images/000001.jpg": EMPTY, "con.txt": EMPTY, "\u00e9\U0001f916": EMPTY}, tmp_path)


@pytest.mark.parametrize("depth", [100, 100_000, 5_000_000])
def test_a_path_of_millions_of_folders_takes_no_time(depth, tmp_path):
    with pytest.raises(InputError, match=MANIFEST):
        fetched({"a/" * depth + "b": EMPTY}, tmp_path)


def test_a_hundred_thousand_entries_of_a_list_are_looked_through_at_once():
    """None of them is there."""
    digests = {f"CW/test_{k}/data.csv": EMPTY for k in range(100_000)}
    store: Any = MemoryStore({MANIFEST: manifest(digests), TAG_MANIFEST: tag_manifest(digests)}, ())
    begin = time.process_time()
    with pytest.raises(InputError, match="is missing, and 99999 more"):
        Remote.from_store(store)
    assert time.process_time() - begin < SECONDS


def test_a_folder_as_a_store_gives_neither_links_nor_pipes(tmp_path):
    """A link is not followed; a pipe is not waited for."""
    shelf = tmp_path / "shelf"
    shelf.mkdir()
    (tmp_path / "secret").write_bytes(b"")
    digests = {"README.md": EMPTY}
    (shelf / MANIFEST).write_bytes(manifest(digests))
    (shelf / TAG_MANIFEST).write_bytes(tag_manifest(digests))
    for make in (lambda path: path.symlink_to(tmp_path / "secret"), os.mkfifo):
        make(shelf / "README.md")
        with pytest.raises(InputError):
            download(Remote.from_store(Folder(f"file://{shelf}", shelf)), tmp_path / "out", LineReport())
        (shelf / "README.md").unlink()
    assert not (tmp_path / "out").exists()


@pytest.fixture(params=["dataset", "bag"])
def folder(request, tmp_path):
    """A whole dataset or bag, and the path of a run in it."""
    root = valid_copy(request.param, tmp_path)
    return root, root / RUN if request.param == "dataset" else root / "data" / RUN


def found(root):
    """Return the faults, which must come at once."""
    begin = time.process_time()
    findings = [str(finding) for finding in verify(root)]
    assert time.process_time() - begin < SECONDS
    return findings


@pytest.mark.parametrize("place", ["data.csv", "side/camera.csv", "side/spec.json", "images/000001.jpg", "extra"])
def test_a_sparse_file_of_a_terabyte_is_a_fault_and_not_hashed(place, folder):
    root, run = folder
    with (run / place).open("wb") as file:
        file.truncate(1 << 40)
    assert any(f"{place}: is larger than 512 MiB" in line for line in found(root))


@pytest.mark.parametrize("target", ["/dev/zero", "/etc/passwd", "../..", "nowhere", "data.csv"])
@pytest.mark.parametrize("place", ["data.csv", "extra", "side"])
def test_a_link_is_a_fault_and_not_followed(place, target, folder):
    root, run = folder
    if (run / place).is_dir():
        shutil.rmtree(run / place)
    (run / place).unlink(missing_ok=True)
    (run / place).symlink_to(target)
    lines = found(root)
    assert any(place in line for line in lines)
    assert not any("root:" in line for line in lines)


@pytest.mark.parametrize(
    "line", ["../" * 40 + "etc/passwd", "/dev/zero", "a/" * 600 + "b", "a/" * 2_000_000 + "b", "\0", "a" * 5000]
)
@pytest.mark.parametrize("name", [MANIFEST, TAG_MANIFEST])
def test_a_list_that_names_other_places_is_a_fault_and_leads_nowhere(name, line, folder):
    root, _ = folder
    listed = (root / name).read_bytes()
    (root / name).write_bytes(listed + f"{EMPTY}  {line}\n".encode())
    assert any(finding.startswith(("manifest", "tagmanifest", "..", "/", "\ufffd", " ")) for finding in found(root))


def test_a_deep_folder_is_a_fault_and_no_crash(folder):
    root, run = folder
    deep = run / "/".join(["d" * 50] * 40)
    deep.mkdir(parents=True)
    (deep / "file").write_bytes(b"")
    assert any("d" * 50 in line for line in found(root))


@pytest.fixture
def of_another_size(tmp_path, monkeypatch):
    """A dataset with one image and one annotation that announce another size than the run's; none may be decoded."""
    root = valid_copy("dataset", tmp_path)
    image = root / RUN / "images" / "000001.jpg"
    data = bytearray(image.read_bytes())
    size_at = data.index(b"\xff\xc0") + 5
    assert data[size_at : size_at + 4] == bytes([0, 16, 0, 24])
    data[size_at : size_at + 4] = struct.pack(">HH", 8192, 8191)
    image.write_bytes(data)
    for number in (2, 3):
        (root / RUN / "images" / f"{number:06d}.jpg").unlink()
    for mask in (root / RUN / "annotations").glob("*/*.png"):
        if mask.name == "000001.png":
            mask.write_bytes(_grey_png(8191, 8192))
        else:
            mask.unlink()
    monkeypatch.setattr("symolo.dataset.pixels.decode_images", lambda *_: pytest.fail("was decoded"))
    return root


def _grey_png(width, height):
    """Of ISO/IEC 15948, with rows that are not there."""
    png = b"\x89PNG\r\n\x1a\n"
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    for kind, content in ((b"IHDR", head), (b"IDAT", zlib.compress(b"")), (b"IEND", b"")):
        png += struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
    return png


def test_an_image_that_announces_another_size_than_the_run_is_not_decoded(of_another_size):
    """Its 758 bytes would take a second of every image, and 400 MB; so would those of an annotation."""
    lines = found(of_another_size)
    assert any("000001.jpg: is 8191 x 8192 px, metadata.json says 24 x 16" in line for line in lines)
    assert any("semantic/000001.png: is no image of 24 x 16 px" in line for line in lines)


def test_a_reader_of_such_an_image_does_not_decode_it(of_another_size):
    image = load(of_another_size)[RUN].image(1)
    for read in (image.pixels, lambda: image.annotation("semantic")):
        with pytest.raises(InputError, match=r"000001\.\w+: is no image of 24 x 16 px; check or repair"):
            read()

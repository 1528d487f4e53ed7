"""A download is whole and right, or nothing is there; what strangers put into a store stays out of other places."""

import hashlib
import shutil
from types import SimpleNamespace

import pytest

from symolo.core.errors import EnvironmentLacking, InputError
from symolo.core.files.new_folder import check_new
from symolo.core.progress import LineReport
from symolo.dataset.manifest import MANIFEST, SIGNATURE, TAG_MANIFEST, manifest, tag_manifest
from symolo.storage import download as download_module
from symolo.storage.comparison import released_files
from symolo.storage.download import Remote, download
from symolo.storage.folder import Folder
from symolo.storage.upload import upload


@pytest.fixture
def filled(release, store):
    """A store that holds the release."""
    upload(released_files(release()), store, LineReport())
    return store


def test_what_was_uploaded_comes_back(filled, release_of, tmp_path):
    out = tmp_path / "out"
    assert download(Remote.from_store(filled), out, LineReport()) == 10
    assert release_of(out) == release_of(tmp_path / "data")
    assert {path.name for path in tmp_path.iterdir()} - {"shelf"} == {"data", "out"}


def test_by_the_command_line(release, release_of, tmp_path, symolo):
    url, out = f"file://{tmp_path}/shelf", tmp_path / "out"
    assert symolo("upload", release(), url).code == 0
    assert symolo("download", url, "--out", out, "--dry-run").out == f"{url}: 10 files, 0.0 MB\n"
    assert not out.exists()
    printed = f"{out}: 10 files, 0.0 MB; 10 of them fetched now\n"
    assert symolo("download", url, "--out", out).out == printed
    assert release_of(out) == release_of(tmp_path / "data")
    again = symolo("download", url, "--out", out)
    assert (again.code, "is there already" in again.err) == (2, True)


def test_signatures_are_counted_among_the_files(release, tmp_path, symolo):
    url, root = f"file://{tmp_path}/shelf", release()
    (root / SIGNATURE).write_bytes(b"untrusted comment: signature\n")
    assert ": 11 files sent" in symolo("upload", root, url).out
    assert ": 11 files, 0.0 MB; 11 of them fetched now\n" in symolo("download", url, "--out", tmp_path / "out").out


class Failing:
    """A store that gives so many objects, and then no more."""

    def __init__(self, store, gives):
        self._store, self._gives = store, iter(range(gives))

    def __getattr__(self, name):
        return getattr(self._store, name)

    def get(self, name):
        if name not in {MANIFEST, TAG_MANIFEST} and next(self._gives, None) is None:
            raise EnvironmentLacking("the network is gone")
        return self._store.get(name)


def test_one_that_was_interrupted_leaves_nothing_and_then_fetches_only_the_rest(filled, release_of, tmp_path, counting):
    out = tmp_path / "out"
    with pytest.raises(EnvironmentLacking, match="the network is gone"):
        download(Remote.from_store(Failing(filled, 3)), out, LineReport())  # pyright: ignore[reportArgumentType] - a proxy
    assert not out.exists()
    came = [path for path in (tmp_path / ".out.download").rglob("*") if path.is_file()]
    assert len([path for path in came if path.name not in {MANIFEST, TAG_MANIFEST}]) == 3
    counted = counting(filled)
    download(Remote.from_store(counted), out, LineReport())
    content = [name for name in counted.got_names if name not in {MANIFEST, TAG_MANIFEST}]
    assert len(content) == 8 - 3
    assert release_of(out) == release_of(tmp_path / "data")


@pytest.mark.parametrize("when", ["while the first one fetches", "after the first one has checked the path"])
def test_of_two_downloads_into_one_folder_one_is_whole_and_the_other_is_refused(
    when, filled, release_of, tmp_path, monkeypatch
):
    out, remote, fill = tmp_path / "out", Remote.from_store(filled), download_module._fill
    begun = []

    def download_again():
        if not begun:
            begun.append(True)
            download(remote, out, LineReport())

    def fill_meanwhile(*arguments):
        with pytest.raises(InputError, match="another symolo command is working in this folder"):
            download_again()
        return fill(*arguments)

    if when == "while the first one fetches":
        monkeypatch.setattr(download_module, "_fill", fill_meanwhile)
        download(remote, out, LineReport())
    else:
        monkeypatch.setattr(download_module, "check_new", lambda path: (check_new(path), download_again()))
        with pytest.raises(InputError, match="another command has written this folder in the meantime"):
            download(remote, out, LineReport())
    assert release_of(out) == release_of(tmp_path / "data")


@pytest.mark.parametrize("name", ["README.md/old.txt", "CW/test_9/images", "CW/test_1/data.csv", "old.txt"])
def test_what_was_begun_of_another_release_is_dropped(filled, release_of, tmp_path, name):
    old = tmp_path / ".out.download" / name
    old.parent.mkdir(parents=True)
    old.write_text("old") if name.endswith(".txt") else old.mkdir()
    download(Remote.from_store(filled), tmp_path / "out", LineReport())
    assert not (tmp_path / "out/CW/test_9").exists()
    assert release_of(tmp_path / "out") == release_of(tmp_path / "data")


def test_it_does_not_gather_behind_a_link(filled, release_of, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / ".out.download").symlink_to(tmp_path / "elsewhere")
    download(Remote.from_store(filled), tmp_path / "out", LineReport())
    assert list((tmp_path / "elsewhere").iterdir()) == []
    assert not (tmp_path / "out").is_symlink()
    assert release_of(tmp_path / "out") == release_of(tmp_path / "data")


def test_a_wrong_byte_leaves_nothing(release, tmp_path, symolo):
    url, shelf, out = f"file://{tmp_path}/shelf", tmp_path / "shelf", tmp_path / "out"
    assert symolo("upload", release(), url).code == 0
    picture = shelf / "CW/test_1/images/000001.jpg"
    picture.write_bytes(b"\xff" + picture.read_bytes()[1:])
    ended = symolo("download", url, "--out", out)
    assert ended.code == 2
    assert (
        f"{url}: CW/test_1/images/000001.jpg: does not match manifest-sha256.txt; upload the release again" in ended.err
    )
    assert not out.exists()
    assert symolo("upload", tmp_path / "data", url).code == 0
    assert symolo("download", url, "--out", out).code == 0


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda shelf: (shelf / TAG_MANIFEST).unlink(), f"holds no finished release: there is no {TAG_MANIFEST}"),
        (lambda shelf: (shelf / MANIFEST).unlink(), f"holds no finished release: there is no {MANIFEST}"),
        (lambda shelf: (shelf / MANIFEST).write_bytes(b"x\n"), "line 1 is not a checksum"),
        (lambda shelf: (shelf / TAG_MANIFEST).write_bytes(b""), f"is not the one that {TAG_MANIFEST} names"),
        (lambda shelf: (shelf / "README.md").unlink(), "README.md is missing; upload the release again"),
        (shutil.rmtree, "holds no finished release"),
    ],
)
def test_what_is_not_whole_is_refused_before_anything_is_fetched(release, tmp_path, symolo, damage, message):
    url = f"file://{tmp_path}/shelf"
    assert symolo("upload", release(), url).code == 0
    damage(tmp_path / "shelf")
    ended = symolo("download", url, "--out", tmp_path / "out")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert message in ended.err
    assert {path.name for path in tmp_path.iterdir()} - {"shelf"} == {"data"}


@pytest.mark.parametrize(
    "name",
    [
        "../escaped",
        "/escaped",
        "a/../../escaped",
        "a//b",
        "./a",
        ".",
        "a/",
        "a" * 300,
        ".stages/kind",
        "tty\x1b[2J",
        MANIFEST,
    ],
)
def test_a_list_cannot_name_a_place_outside(name):
    digests = {name: hashlib.sha256(b"x").hexdigest()}
    with pytest.raises(InputError, match="names something that is not a file of a release"):
        Remote.from_store(_Stranger(digests))  # pyright: ignore[reportArgumentType] - only two methods


def test_a_list_cannot_name_a_file_below_a_file():
    digests = dict.fromkeys(("a", "a/b"), hashlib.sha256(b"x").hexdigest())
    with pytest.raises(InputError, match="names something that is not a file of a release: got 'a'"):
        Remote.from_store(_Stranger(digests))  # pyright: ignore[reportArgumentType] - only two methods


class _Stranger:
    """A store with lists that fit each other, and every object that they name."""

    url = "s3://bucket/stranger"

    def __init__(self, digests):
        lists = {MANIFEST: manifest(digests), TAG_MANIFEST: tag_manifest(digests)}
        self._objects = dict.fromkeys(digests, b"x") | lists

    def sizes(self):
        return {name: len(content) for name, content in self._objects.items()}

    def get(self, name):
        return self._objects.get(name)


def test_a_disk_without_room_is_reported_before_anything_is_fetched(release, tmp_path, monkeypatch, counting):
    shelf = Folder(f"file://{tmp_path}/shelf", tmp_path / "shelf")
    upload(released_files(release()), shelf, LineReport())
    counted = counting(shelf)
    monkeypatch.setattr("shutil.disk_usage", lambda _path: SimpleNamespace(free=100))
    with pytest.raises(EnvironmentLacking, match=r"are free; free some space, or name a folder on another disk"):
        download(Remote.from_store(counted), tmp_path / "out", LineReport())
    assert counted.got_names == [MANIFEST, TAG_MANIFEST]

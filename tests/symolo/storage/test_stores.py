"""What every kind of store does."""

import asyncio
import hashlib
import os

import obstore
import pytest
from obstore.store import MemoryStore

from symolo.core.errors import EnvironmentLacking, InputError
from symolo.storage import base
from symolo.storage.base import LocalFile
from symolo.storage.bucket import Bucket
from symolo.storage.folder import Folder

OF_ABC = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
"""SHA-256 of `abc`: FIPS 180-4, example of NIST."""


def local(folder, content, name="CW/test_1/data.csv"):
    path = folder / "local"
    path.write_bytes(content)
    return LocalFile(name, path, len(content), hashlib.sha256(content).hexdigest())


def test_an_object_is_what_was_put(store, tmp_path):
    store.put(local(tmp_path, b"abc"))
    assert store.get("CW/test_1/data.csv") == b"abc"
    assert store.sizes() == {"CW/test_1/data.csv": 3}
    assert store.digest("CW/test_1/data.csv") == OF_ABC


def test_a_place_that_nobody_used_is_empty(store):
    assert store.sizes() == {}
    assert store.get("CW/test_1/data.csv") is None


@pytest.mark.parametrize("size", [0, 1, 9, 10, 11, 20, 35])
def test_a_file_of_several_chunks_is_whole(store, tmp_path, size, monkeypatch):
    monkeypatch.setattr(base, "CHUNK_BYTES", 10)
    content = bytes(range(size))
    store.put(local(tmp_path, content))
    assert store.get("CW/test_1/data.csv") == content


@pytest.mark.parametrize("size", [4, 35])
def test_a_file_that_changed_since_it_was_checked_does_not_take_the_place_of_a_good_one(
    store, tmp_path, size, monkeypatch
):
    monkeypatch.setattr(base, "CHUNK_BYTES", 10)
    file = local(tmp_path, b"a" * size)
    store.put(file)
    file.path.write_bytes(b"b" * size)
    with pytest.raises(InputError, match="has changed meanwhile"):
        store.put(file)
    assert store.get(file.name) == b"a" * size


def test_what_a_killed_upload_left_is_no_object_and_is_swept(tmp_path):
    store = Folder("file:///shelf", tmp_path / "shelf")
    with store.locked():
        store.put(local(tmp_path, b"abc"))
        (tmp_path / "shelf/CW/test_1/.data.csv.0123456789abcdef.tmp").write_bytes(b"a")
        assert store.sizes() == {"CW/test_1/data.csv": 3}
        store.sweep()
    assert [path.name for path in (tmp_path / "shelf").rglob("*") if path.is_file()] == ["data.csv"]


def test_a_link_and_a_pipe_are_no_objects(tmp_path):
    shelf = tmp_path / "shelf"
    shelf.mkdir()
    (shelf / "link.csv").symlink_to(tmp_path)
    os.mkfifo(shelf / "pipe.csv")
    assert Folder("file:///shelf", shelf).sizes() == {}


def test_a_folder_is_never_written_to_through_a_link(tmp_path):
    (tmp_path / "shelf").mkdir()
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "shelf/CW").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(InputError, match="leads through a link"):
        Folder("file:///shelf", tmp_path / "shelf").put(local(tmp_path, b"abc"))
    assert list((tmp_path / "elsewhere").iterdir()) == []


@pytest.fixture
def bucket():
    bucket = Bucket("s3://bucket/data", MemoryStore())
    for name in ("a", "b", "c"):
        obstore.put(bucket._store, name, b"12345")
    return bucket


def test_an_object_that_announces_more_than_a_file_of_a_release_has_is_not_fetched(bucket, monkeypatch):
    """The library would allocate as much, and end the process where it gets no memory."""
    assert bucket.get("a") == b"12345"
    monkeypatch.setattr("symolo.storage.bucket.MAX_OBJECT_BYTES", 4)
    with pytest.raises(InputError, match=r"s3://bucket/data: a: is no file of a release: got 5, allowed: at most 4"):
        bucket.get("a")


def test_a_listing_of_more_objects_than_a_release_has_is_refused(bucket, monkeypatch):
    assert bucket.sizes() == {"a": 5, "b": 5, "c": 5}
    monkeypatch.setattr("symolo.storage.bucket.MAX_OBJECTS", 2)
    with pytest.raises(InputError, match="s3://bucket/data: holds more than 2 objects, as no release does"):
        bucket.sizes()


def test_a_listing_that_gets_no_further_is_given_up(bucket, monkeypatch):
    class Stuck:
        def list(self, _store, **_):
            return self

        def __aiter__(self):
            return self

        async def __anext__(self):
            await asyncio.sleep(60)

    bucket._obstore = Stuck()
    monkeypatch.setattr("symolo.storage.bucket.LIST_S", 0.05)
    with pytest.raises(EnvironmentLacking, match=r"has listed nothing more for 0\.05 s; see that"):
        bucket.sizes()

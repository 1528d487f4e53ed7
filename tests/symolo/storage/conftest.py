"""A release of a few small files, and a store that counts what it is asked and can fail at a given put."""

import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from obstore.store import MemoryStore

from symolo.core.errors import EnvironmentLacking
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST, manifest, released_hashes, tag_manifest
from symolo.storage.base import Store
from symolo.storage.bucket import Bucket
from symolo.storage.folder import Folder

CONTENT = {
    "README.md": b"# A release\n",
    "metadata.json": b"{}\n",
    "bag-info.txt": b"Payload-Oxum: 1.1\n",
    "CW/test_1/data.csv": b"t,x\n0,1\n",
    "CW/test_1/images/000001.jpg": bytes(range(256)) * 4,
    "CW/test_1/images/000002.jpg": bytes(range(255, -1, -1)) * 4,
    "CW/test_1/images/000003.jpg": b"",
    "CCW/test_1/data.csv": b"t,x\n0,2\n",
}


@pytest.fixture
def release(tmp_path: Path) -> Callable[..., Path]:
    """Makes one; `changes` replace or add files."""

    def make(name: str = "data", **changes: bytes) -> Path:
        root = tmp_path / name
        for path, content in {**CONTENT, **changes}.items():
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).write_bytes(content)
        hashes = released_hashes(root)
        (root / MANIFEST).write_bytes(manifest(hashes))
        (root / TAG_MANIFEST).write_bytes(tag_manifest(hashes))
        return root

    return make


class Counting:
    """A store whose `stop_at`-th put is the first of those that fail, as of a network that is gone."""

    def __init__(self, store: Store, stop_at: int | None = None) -> None:
        self._store, self._stop_at, self._lock = store, stop_at, threading.Lock()
        self.put_names: list[str] = []
        self.got_names: list[str] = []

    def __getattr__(self, name):
        return getattr(self._store, name)

    def put(self, file):
        with self._lock:
            if self._stop_at is not None and len(self.put_names) >= self._stop_at:
                raise EnvironmentLacking("the network is gone")
            self.put_names.append(file.name)
        self._store.put(file)

    def get(self, name):
        with self._lock:
            self.got_names.append(name)
        return self._store.get(name)


@pytest.fixture
def counting() -> type[Counting]:
    return Counting


@pytest.fixture(params=["folder", "bucket"])
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Store:
    if request.param == "bucket":
        return Bucket("s3://bucket/data", MemoryStore())
    return Folder(f"file://{tmp_path}/shelf/data", tmp_path / "shelf/data")

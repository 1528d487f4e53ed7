"""A small release made over and over under faults, and what its folder must look like whenever somebody looks."""

import dataclasses
import hashlib
import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

FOLDER = Path(__file__).parent
HIDDEN = re.compile(r"(^|/)(\.[^/]+\.tmp|\.[^/]+\.dropped|[^/]+\.tmp)(/|$)")
"""Names under which something may lie unfinished."""
JOURNAL = re.compile(r"\.stages/.*\.jsonl$")
"""Grows by what was done, so that it tells of the interruptions."""

TINY = ["release", str(FOLDER / "bare.yaml")]


def tree_of(out: Path) -> dict[str, str]:
    """SHA-256 of every file by its path inside, but for journals; one that is being removed is not there."""
    found = {}
    for path in sorted(out.rglob("*")):
        name = path.relative_to(out).as_posix()
        if path.is_file() and not JOURNAL.search(name):
            found[name] = hashlib.sha256(path.read_bytes()).hexdigest()
    return found


def wrong_in(out: Path, whole: dict[str, str]) -> list[str]:
    """Files under a name that counts whose bytes are not those of the whole tree."""
    there = tree_of(out) if out.exists() else {}
    return [name for name, digest in there.items() if not HIDDEN.search(name) and whole.get(name) != digest]


class Server:
    """`release_server.py` at the other end of two pipes."""

    def __init__(self) -> None:
        command = [sys.executable, str(FOLDER / "release_server.py")]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert "ready\n" in iter(self._process.stdout.readline, "")  # an engine greets first

    def release(self, out: Path, workers: int = 1, **order: object) -> SimpleNamespace:
        """Do `symolo release` of the tiny scenario into a folder; `order` as `release_server.Order` has it."""
        order = {"arguments": [*TINY, "--out", str(out), "--workers", str(workers)], **order}
        self._process.stdin.write(json.dumps(order) + "\n")
        self._process.stdin.flush()
        return SimpleNamespace(**json.loads(self._process.stdout.readline()))

    def close(self) -> None:
        self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()


@dataclasses.dataclass(frozen=True)
class Whole:
    """A release that nothing disturbed."""

    tree: dict[str, str]
    sizes: list[int]
    """Of its files [bytes]."""
    seconds: float
    operations: list[list[str]]


@pytest.fixture(scope="session")
def server() -> Iterator[Server]:
    server = Server()
    yield server
    server.close()


@pytest.fixture(scope="session")
def whole(server: Server, tmp_path_factory: pytest.TempPathFactory) -> Whole:
    out = tmp_path_factory.mktemp("whole") / "data"
    done = server.release(out, root=str(out.parent))
    assert done.status == 0, done.err
    assert len(done.operations) > 100
    sizes = [path.stat().st_size for path in out.rglob("*") if path.is_file()]
    return Whole(tree_of(out), sizes, done.seconds, done.operations)


@pytest.fixture(scope="session")
def wrong():
    return wrong_in


@pytest.fixture(scope="session")
def tree():
    return tree_of

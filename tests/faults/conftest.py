"""A small release made over and over under faults, and what its folder must look like whenever somebody looks."""

import contextlib
import dataclasses
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from blender_scenes.render.job_file import write_job
from configs.draw import draw_all
from configs.loader import load_scenario
from pipeline.run_folder.first_stage import read_recording
from pipeline.run_folder.stored_spec import spec_problem
from pipeline.run_folder.workspace import Workspace
from pipeline.stages.assemble import assemble
from pipeline.stages.cameras import cameras_of
from pipeline.stages.render import RenderTask
from pipeline.stages.simulate_runs import simulate_into, simulation_key
from symolo.core.files.atomic_files import make_folder
from symolo.core.files.file_hashes import sha256_of
from symolo.core.progress import LineReport
from symolo.dataset.tables.rows import Rows
from symolo.verification.verify import verify

FOLDER = Path(__file__).parent
HIDDEN = re.compile(r"(^|/)(\.[^/]+\.tmp|\.[^/]+\.dropped|[^/]+\.tmp)(/|$)")
"""Names under which something may lie unfinished."""
JOURNAL = re.compile(r"\.stages/.*\.jsonl$")
"""A journal: it grows with each attempt, so it differs after an interruption."""

TINY = ["release", str(FOLDER / "bare.yaml")]
SETTINGS = ["stop.time_limit_s=0.4", "render.width_px=32", "render.height_px=24"]


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

    def __init__(self, **environment: str) -> None:
        command = [sys.executable, str(FOLDER / "release_server.py")]
        pipe, variables = subprocess.PIPE, {**os.environ, **environment}
        self._process = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True, env=variables)
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._orders, self._outcomes = self._process.stdin, self._process.stdout
        assert "ready\n" in iter(self._outcomes.readline, "")  # an engine greets first

    def release(self, out: Path, workers: int = 1, **order: object) -> SimpleNamespace:
        """Do `symolo release` of the tiny scenario into a folder; `order` as `release_server.Order` has it."""
        order = {"arguments": [*TINY, "--out", str(out), "--workers", str(workers)], **order}
        self._orders.write(json.dumps(order) + "\n")
        self._orders.flush()
        return SimpleNamespace(**json.loads(self._outcomes.readline()))

    def close(self) -> None:
        self._orders.close()
        self._process.wait()
        self._outcomes.close()


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


@pytest.fixture
def server_with() -> Iterator[Callable[..., Server]]:
    """Starts one with further environment variables."""
    with contextlib.ExitStack() as stack:

        def start(**environment: str) -> Server:
            server = Server(**environment)
            stack.callback(server.close)
            return server

        yield start


@pytest.fixture(scope="session")
def whole(server: Server, tmp_path_factory: pytest.TempPathFactory) -> Whole:
    out = tmp_path_factory.mktemp("whole") / "data"
    done = server.release(out, root=str(out.parent))
    assert done.status == 0, done.err
    assert len(done.operations) > 100
    sizes = [path.stat().st_size for path in out.rglob("*") if path.is_file()]
    return Whole(tree_of(out), sizes, done.seconds, done.operations)


class Disk:
    """One of tmpfs, whose files take whole pages of 4096 bytes. Only root can mount one."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def leave(self, pages: int) -> None:
        """Make the disk so small that this many pages are free."""
        if not self._used_kib():  # a size of 0 would be no limit
            (self.folder / ".something").write_bytes(bytes(4096))
        self._resize(f"{self._used_kib() + 4 * pages}k")

    def _used_kib(self) -> int:
        status = os.statvfs(self.folder)
        return (status.f_blocks - status.f_bfree) * status.f_frsize // 1024

    def enlarge(self) -> None:
        """Make room for all."""
        self._resize("64m")

    def _resize(self, size: str) -> None:
        _run("mount", "-o", f"remount,size={size}", self.folder)


def _run(program: str, *arguments: object) -> None:
    subprocess.run([shutil.which(program) or program, *map(str, arguments)], check=True, capture_output=True)


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[Disk]:
    """Mounted at `tmp_path / "work"`."""
    folder = tmp_path / "work"
    folder.mkdir()
    _run("mount", "-t", "tmpfs", "-o", "size=64m", "tmpfs", folder)
    yield Disk(folder)
    _run("umount", folder)


@pytest.fixture(scope="session")
def wrong():
    return wrong_in


@pytest.fixture(scope="session")
def tree():
    return tree_of


@pytest.fixture(scope="session")
def release(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two runs of 0.4 s; its images are noise, for what they show plays no part here."""
    workspace = Workspace(tmp_path_factory.mktemp("release") / "data")
    loaded = load_scenario("smoke", SETTINGS)
    specs = draw_all(loaded)
    rng = np.random.default_rng(1)
    with workspace.locked():
        for spec in specs:
            path = workspace.simulate(spec.key).path
            simulate_into(spec.model_dump_json(), path, simulation_key(spec), lambda _share: None)
            rows = Rows.from_recording(read_recording(path))
            order = RenderTask.of_camera(cameras_of(spec)[0], rows, workspace.render(spec.key))
            make_folder(order.task.files)
            write_job(order.task.folder.path, order.job_text)
            hashes = {}
            for name in order.task.names():
                cv2.imwrite(str(order.task.files / name), rng.integers(30, 220, (24, 32, 3), dtype=np.uint8))
            for name in order.task.names():
                hashes[name] = sha256_of(order.task.files / name)
            order.task.finish(hashes)
        assemble(workspace, loaded.tree, specs, [], LineReport())
    assert list(verify(workspace.out, spec_problem)) == []
    return workspace.out

"""The output folder: whether it may be used, where each stage of each run lies in it, and what is done."""

import contextlib
import fcntl
import hashlib
import os
import shutil
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from configs.errors import EnvironmentLacking, InputError
from pipeline.files import canonical_json, hashes_of, holds, replace_folder, write_file

DONE = "done.json"
STAGES = ".stages"
PARTIAL = ".tmp"


def input_key(stage: str, **inputs: object) -> str:
    """SHA-256 over everything that a stage's result depends on; an equal key means nothing to redo."""
    return hashlib.sha256(canonical_json({"stage": stage, **inputs})).hexdigest()


class Done(BaseModel):
    """What `done.json` says."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    key: str
    files: dict[str, str]
    """SHA-256 by path inside the folder."""


@dataclass(frozen=True)
class StageFolder:
    """One stage of one run; `done.json` is its last file and names its input key and the hash of each file."""

    path: Path

    def is_done(self, key: str) -> bool:
        """Whether the folder was finished from the same inputs and each of its files is still what was written."""
        done = self.done()
        return done is not None and done.key == key and holds(self.path, done.files)

    def start(self) -> Path:
        """An empty folder beside the final one, to be filled and handed to `publish`."""
        partial = self.path.with_name(self.path.name + PARTIAL)
        shutil.rmtree(partial, ignore_errors=True)
        partial.mkdir(parents=True)
        return partial

    def publish(self, partial: Path, key: str) -> None:
        mark_done(partial, key)
        replace_folder(partial, self.path)

    def done(self) -> Done | None:
        """What `done.json` says, None while the stage is not finished."""
        try:
            return Done.model_validate_json((self.path / DONE).read_bytes())
        except (OSError, ValidationError):
            return None


def mark_done(folder: Path, key: str, files: dict[str, str] | None = None) -> None:
    """Write `done.json` for the files named, or for all that the folder holds."""
    files = hashes_of(folder, skip=(DONE,)) if files is None else files
    write_file(folder / DONE, canonical_json(Done(key=key, files=files).model_dump()))


@dataclass(frozen=True)
class Workspace:
    """`out` with its released runs, and the hidden `.stages` that a rerun continues from."""

    out: Path

    def simulate(self, run_key: str) -> StageFolder:
        return StageFolder(self.out / STAGES / "simulate" / run_key)

    def render(self, run_key: str) -> StageFolder:
        return StageFolder(self.out / STAGES / "render" / run_key)

    def assemble(self, run_key: str) -> StageFolder:
        return StageFolder(self.out / STAGES / "assemble" / run_key)

    @contextlib.contextmanager
    def locked(self) -> Iterator[None]:
        """Hold the folder for this process; the operating system lets go of it however the process ends."""
        (self.out / STAGES).mkdir(parents=True, exist_ok=True)
        descriptor = os.open(self.out / STAGES, os.O_RDONLY | os.O_DIRECTORY)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            yield
        except BlockingIOError:
            raise InputError(
                "another symolo command is working in this folder",
                where=f"--out {self.out}",
                cure="wait for it, or name another folder",
            ) from None
        finally:
            os.close(descriptor)


def check_out(out: Path) -> None:
    """Refuse a folder that cannot or should not be written to, before any work starts.

    Raises:
        InputError: It is a file, foreign and not empty, or not writable.
    """
    where = f"--out {out}"
    if out.exists() and not out.is_dir():
        raise InputError("is a file, not a folder", where=where, cure="name a folder that is new or empty")
    if out.is_dir() and not (out / STAGES).is_dir() and any(out.iterdir()):
        raise InputError("holds files that symolo did not make", where=where, cure="name a folder that is new or empty")
    nearest = _nearest_existing(out)
    if not nearest.is_dir():
        raise InputError(f"lies below the file {nearest}", where=where, cure="name a folder that is new or empty")
    try:
        tempfile.TemporaryFile(dir=nearest).close()
    except OSError as error:
        what = f"cannot be written: {nearest}: {error.strerror}"
        raise InputError(what, where=where, cure="name another folder") from None


def check_disk(out: Path, needed_bytes: int) -> None:
    """Raise EnvironmentLacking when there is no room for `needed_bytes` where `out` is or will be."""
    free = shutil.disk_usage(_nearest_existing(out)).free
    there = sum(path.stat().st_size for path in out.rglob("*") if path.is_file())
    if free + there < needed_bytes:
        raise EnvironmentLacking(
            f"--out {out}: about {needed_bytes / 1e6:.0f} MB are needed and {free / 1e6:.0f} MB are free; "
            "free some space, name a folder on another disk, or lower render.width_px and render.height_px"
        )


def _nearest_existing(path: Path) -> Path:
    path = path.absolute()
    while not path.exists():
        path = path.parent
    return path

"""The output folder: its lock, the folder of each stage of each run, and what is done."""

import contextlib
import hashlib
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from symolo.core.errors import EnvironmentLacking
from symolo.core.files.atomic_files import (
    make_folder,
    new_folder_beside,
    place_of,
    remove_folder,
    remove_leftovers,
    replace_folder,
    write_file,
)
from symolo.core.files.file_hashes import canonical_json, hashes_of, holds
from symolo.core.files.file_locks import lock_or_refuse, locked, opened_lock
from symolo.core.files.plain_files import FileKind, check_tree, read_file
from symolo.core.os_errors import NOT_THERE
from symolo.dataset.folder_kind import KIND, Done, Kind
from symolo.dataset.layout import DONE, STAGES, camera_folder

FAILED = "failed.json"


def input_key(stage: str, **inputs: object) -> str:
    """Return the SHA-256 of everything that the result of a stage depends on. An equal key means nothing to redo."""
    return hashlib.sha256(canonical_json({"stage": stage, **inputs})).hexdigest()


class _Failed(BaseModel):
    """Content of `failed.json`."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    key: str
    problem: str


@dataclass(frozen=True)
class StageFolder:
    """The folder of one stage of one run. Its last file, `done.json`, holds its input key and the hash of each file."""

    path: Path

    def is_done(self, key: str) -> bool:
        """Return whether the folder was finished from the same inputs and each of its files is unchanged."""
        done = self.done()
        return done is not None and done.key == key and holds(self.path, done.files)

    def start(self) -> Path:
        """Return an empty folder beside the final one, to be filled and passed to `publish`."""
        return new_folder_beside(self.path)

    def is_begun(self) -> bool:
        """Return whether a command has started to fill the folder."""
        return any(place_of(path) == self.path for path in self.path.parent.glob(".*.tmp"))

    def publish(self, partial: Path, key: str, *, over: bool = False) -> None:
        """Put the filled folder in place, unless there is one that others made from the same inputs.

        Others may be reading that one, and the same inputs give the same bytes. A real board does not give the same
        bytes; with `over` the folder is replaced in any case.
        """
        mark_done(partial, key)
        with locked(self.path.parent):
            if self.is_done(key) and not over:
                remove_folder(partial)
            else:
                replace_folder(partial, self.path)

    def fail(self, key: str, problem: str) -> None:
        """Record that no release can be made from these inputs, for the stages after this one."""
        write_file(self.path / FAILED, canonical_json(_Failed(key=key, problem=problem).model_dump()))

    def problem(self, key: str | None = None) -> str:
        """Return why the stage failed with these inputs, or with any; empty where that is unknown."""
        try:
            failed = _Failed.model_validate_json(read_file(self.path / FAILED, FileKind.DOCUMENT))
        except (*NOT_THERE, ValidationError):
            return ""
        return failed.problem if key in {None, failed.key} else ""

    def files(self) -> dict[str, str]:
        """Return the SHA-256 of the finished stage's files by their path in the folder.

        Raises:
            EnvironmentLacking: The stage is not finished, though it was a moment ago.
        """
        done = self.done()
        if done is None:
            raise EnvironmentLacking(f"{self.path} has changed since it was made; run the same command again")
        return done.files

    def done(self) -> Done | None:
        """Return the content of `done.json`; None while the stage is not finished."""
        try:
            return Done.model_validate_json(read_file(self.path / DONE, FileKind.DOCUMENT))
        except (*NOT_THERE, ValidationError):
            return None


def mark_done(folder: Path, key: str, files: dict[str, str] | None = None) -> None:
    """Write `done.json` for these files, or for all files of the folder."""
    files = hashes_of(folder, skip=(DONE,)) if files is None else files
    write_file(folder / DONE, canonical_json(Done(key=key, files=files).model_dump()))


@dataclass(frozen=True)
class Workspace:
    """An output folder with its released runs, and its hidden `.stages`, from which a later command continues."""

    out: Path
    kind: Kind = Kind.DATASET

    def simulate(self, run_key: str) -> StageFolder:
        return StageFolder(self.out / STAGES / "simulate" / run_key)

    def render(self, run_key: str, camera: str = "") -> StageFolder:
        return StageFolder(self._camera_stages(camera) / "render" / run_key)

    def annotate(self, run_key: str, camera: str = "") -> StageFolder:
        return StageFolder(self._camera_stages(camera) / "annotate" / run_key)

    def _camera_stages(self, camera: str) -> Path:
        """Return the folder of the stages of a further camera, or of the camera of data.csv."""
        return self.out / STAGES / camera_folder(camera) if camera else self.out / STAGES

    def assemble(self, run_key: str) -> StageFolder:
        return StageFolder(self.out / STAGES / "assemble" / run_key)

    @property
    def user_files(self) -> Path:
        """Folder of the user's images and panoramas, each under its SHA-256."""
        return self.out / STAGES / "assets"

    @contextlib.contextmanager
    def locked(self, *, alone: bool = True) -> Iterator[None]:
        """Lock the folder for this process; the operating system unlocks it however the process ends.

        Several processes that each do a part of the work lock it together; they pass `alone` as False.

        Raises:
            InputError: Another command works in it, or a folder of the stages is a link.
        """
        check_tree(self.out, STAGES)
        make_folder(self.out / STAGES)
        descriptor = opened_lock(self.out / STAGES)
        try:
            lock_or_refuse(descriptor, f"--out {self.out}", shared=not alone)
            if not (self.out / STAGES / KIND).exists():
                write_file(self.out / STAGES / KIND, f"{self.kind}\n".encode())
            if alone:
                self._sweep()
            yield
        finally:
            os.close(descriptor)

    def _sweep(self) -> None:
        """Remove the unfinished files of killed commands."""
        routes = [path for path in self.out.iterdir() if path.is_dir() and not path.name.startswith(".")]
        for folder in (self.out, *routes):
            remove_leftovers(folder)
        remove_leftovers(self.out / STAGES, below=True)

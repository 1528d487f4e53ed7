"""Logs that a user names, each read by the reader that recognises it."""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from logs.trajectories.bag import READER as BAG
from logs.trajectories.base import LoggedTrajectory, ReadSettings, TrajectoryReader
from logs.trajectories.body_place import moved_to_axle
from logs.trajectories.readers import READERS
from logs.trajectories.table import READER as TABLE
from symolo.core.errors import InputError, nearest
from symolo.core.files.file_hashes import sha256_of
from symolo.core.files.plain_files import FileKind
from symolo.dataset.documents.origin import LogOrigin


@dataclass(frozen=True)
class ReadLog:
    """A trajectory of a log, and what identifies the log."""

    path: Path
    """The file or folder that the user named."""
    trajectory: LoggedTrajectory
    origin: LogOrigin

    @property
    def title(self) -> str:
        """Name of the log, and that of the trajectory where the log has several."""
        return f"{self.path}{f' ({self.trajectory.name})' if self.trajectory.name else ''}"


def reader_of(path: Path, name: str | None, *, is_mapped: bool = False) -> TrajectoryReader:
    """Return the reader of this name, or the one that recognises the path.

    Args:
        path: File or folder.
        name: Name of the reader, or None.
        is_mapped: Whether a mapping file names columns, so that a file of no known form is a table.

    Raises:
        InputError: There is no such path or reader, or none recognises the path.
    """
    names = [reader.name for reader in READERS]
    if name is not None and name not in names:
        raise InputError("--format", got=name, allowed=", ".join(names), nearest=nearest(name, names))
    if not (path.is_file() or path.is_dir()):
        raise InputError("no such file or folder", where=str(path), cure="name a log")
    if path.is_file() and not path.stat().st_size:
        raise InputError("is empty", where=str(path), cure="record it again, or name another log")
    for reader in READERS:
        if reader.name == name or (name is None and reader.recognises(path)):
            return reader
    if is_mapped and path.is_file():
        return TABLE
    known = "; ".join(f"{reader.name}: {reader.what}" for reader in READERS)
    raise InputError("is not a log of a known form", where=str(path), allowed=known, cure="or choose one with --format")


def read_logs(paths: Sequence[Path], name: str | None, settings: ReadSettings) -> Iterator[ReadLog]:
    """Yield the trajectories of logs.

    Args:
        paths: Files or folders.
        name: Name of the reader; recognised from each path by default.
        settings: How to read them.

    Raises:
        InputError: A log cannot be read; file, row and column are named.
    """
    for path in paths:
        reader = reader_of(path, name, is_mapped=settings.mapping is not None)
        try:
            trajectories = reader.read(path, settings)
            digest = _sha256(path, FileKind.BAG if reader is BAG else FileKind.ANY)
        except OSError as error:
            where = str(error.filename or path)
            raise InputError(f"cannot be read: {error.strerror}", where=where, cure="check its permissions") from None
        for trajectory in moved_to_axle(trajectories, settings.body_at_m):
            origin = LogOrigin(
                file=path.absolute().name,
                sha256=digest,
                format=reader.name,
                quantities=dict(trajectory.quantities),
                changes=trajectory.changes,
            )
            yield ReadLog(path, trajectory, origin)


def _sha256(path: Path, kind: FileKind) -> str:
    """Return the SHA-256 of a file, or of the files of a folder in the order of their names."""
    if path.is_file():
        return sha256_of(path.resolve(), kind)
    whole = hashlib.sha256()
    for file in sorted(file for file in path.rglob("*") if file.is_file()):
        whole.update(f"{sha256_of(file.resolve(), kind)}  {file.relative_to(path).as_posix()}\n".encode())
    return whole.hexdigest()

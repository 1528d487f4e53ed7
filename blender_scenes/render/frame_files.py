"""Pictures on disk: put in place whole or not at all, and known again by their hash."""

import contextlib
import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from pydantic import TypeAdapter, ValidationError

from symolo.core.atomic_files import append_line, write_file


@dataclass(frozen=True)
class FrameFile:
    """One finished picture, or another file of its frame."""

    number: int
    file: str
    """Path within the folder of the pictures."""
    sha256: str
    size_bytes: int
    seconds: float
    """What rendering, developing and writing it took."""
    threads: int = 1
    """Of Cycles meanwhile."""
    cpu: str = ""
    """Class of the processor that made it; empty where it was not noted."""


@dataclass(frozen=True)
class _Entry:
    job_sha256: str
    frame: FrameFile


_ENTRY = TypeAdapter(_Entry)


def put_in_place(data: bytes, path: Path, width_px: int, height_px: int) -> str:
    """Decodes an encoded picture, puts it in place and returns its SHA-256.

    Raises:
        OSError: The disk did not keep what was written, or the picture does not decode to its size.
    """
    if not _decodes(data, width_px, height_px):
        raise OSError(f"{path}: is not the one written: it does not decode to {width_px} x {height_px} px")
    return put_data_in_place(data, path)


def put_data_in_place(data: bytes, path: Path) -> str:
    """Puts a file in place and returns its SHA-256; raises what `write_file` does."""
    write_file(path, data)
    return hashlib.sha256(data).hexdigest()


def _decodes(data: bytes, width_px: int, height_px: int) -> bool:
    pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    return pixels is not None and pixels.shape == (height_px, width_px, 3)


class Ledger:
    """The record of finished pictures beside their folder, one line each, so that a killed run loses none."""

    def __init__(self, images_dir: Path, job_sha256: str) -> None:
        self._images_dir = images_dir
        self._job_sha256 = job_sha256
        self._path = images_dir.with_name(f"{images_dir.name}.jsonl")

    def add(self, frame: FrameFile) -> None:
        append_line(self._path, _ENTRY.dump_json(_Entry(self._job_sha256, frame)))

    def files(self) -> list[FrameFile]:
        """All that was ever put in place for a job, in that order, what was made again too."""
        return [entry.frame for entry in self._entries() if entry.job_sha256 == self._job_sha256]

    def whole_files(self) -> dict[str, FrameFile]:
        """Recorded files of this job that lie in the folder as they were written, by their path in it."""
        recorded = {frame.file: frame for frame in self.files()}
        return {name: frame for name, frame in recorded.items() if self._is_whole(frame)}

    def processors(self) -> tuple[str, ...]:
        """Classes of those that made this job's files, each as it was put in place last; none that was not noted."""
        last = {frame.file: frame.cpu for frame in self.files()}
        return tuple(sorted({*last.values()} - {""}))

    def _entries(self) -> Iterator[_Entry]:
        if not self._path.exists():
            return
        for line in self._path.read_bytes().splitlines():
            with contextlib.suppress(ValidationError):  # a line cut short by a kill
                yield _ENTRY.validate_json(line)

    def _is_whole(self, frame: FrameFile) -> bool:
        path = self._images_dir / frame.file
        if not path.is_file() or path.stat().st_size != frame.size_bytes:
            return False
        return hashlib.sha256(path.read_bytes()).hexdigest() == frame.sha256

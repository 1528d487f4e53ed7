"""Images on disk: written completely or not at all, and recognised by their hash."""

import contextlib
import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import TypeAdapter, ValidationError

from symolo.core.files.atomic_files import append_line, write_file
from symolo.core.files.plain_files import FileKind, read_file


@dataclass(frozen=True)
class FrameFile:
    """A finished image, or another file of a frame."""

    number: int
    file: str
    """Path within the folder of the images."""
    sha256: str
    size_bytes: int
    seconds: float
    """Time of rendering, developing and writing."""
    threads: int = 1
    """Number of Cycles' threads."""
    cpu: str = ""
    """Class of the processor that made it; empty if it was not recorded."""


@dataclass(frozen=True)
class _Entry:
    job_sha256: str
    frame: FrameFile


_ENTRY = TypeAdapter(_Entry)


def put_in_place(data: bytes, path: Path, width_px: int, height_px: int) -> str:
    """Check that an encoded image decodes to its size, put it in place and return its SHA-256.

    Raises:
        OSError: The image does not decode to its size, or the disk did not keep what was written.
    """
    import cv2  # noqa: PLC0415 - takes long to load, and commands without images read only the form of the messages

    pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    if pixels is None or pixels.shape != (height_px, width_px, 3):
        raise OSError(f"{path}: is not the one written: it does not decode to {width_px} x {height_px} px")
    return put_data_in_place(data, path)


def put_data_in_place(data: bytes, path: Path) -> str:
    """Put a file in place and return its SHA-256; errors are those of `write_file`."""
    write_file(path, data)
    return hashlib.sha256(data).hexdigest()


class Ledger:
    """The journal of finished files beside their folder, one line for each, so that a killed run loses none."""

    def __init__(self, images_dir: Path, job_sha256: str) -> None:
        self._images_dir = images_dir
        self._job_sha256 = job_sha256
        self._path = images_dir.with_name(f"{images_dir.name}.jsonl")

    def add(self, frame: FrameFile) -> None:
        append_line(self._path, _ENTRY.dump_json(_Entry(self._job_sha256, frame)))

    def files(self) -> list[FrameFile]:
        """Return all files that were put in place for this job, in that order, repeated ones included."""
        return [entry.frame for entry in self._entries() if entry.job_sha256 == self._job_sha256]

    def whole_files(self) -> dict[str, FrameFile]:
        """Return the files of this job that are in the folder as they were written, by their path in it."""
        recorded = {frame.file: frame for frame in self.files()}
        return {name: frame for name, frame in recorded.items() if self._is_whole(frame)}

    def processors(self) -> tuple[str, ...]:
        """Return the classes of the processors that made this job's files, as far as they were recorded."""
        last = {frame.file: frame.cpu for frame in self.files()}
        return tuple(sorted({*last.values()} - {""}))

    def _entries(self) -> Iterator[_Entry]:
        if not self._path.exists():
            return
        for line in read_file(self._path, FileKind.JOB).splitlines():
            with contextlib.suppress(ValidationError):  # the last line of a killed process may be incomplete
                yield _ENTRY.validate_json(line)

    def _is_whole(self, frame: FrameFile) -> bool:
        path = self._images_dir / frame.file
        if not path.is_file() or path.stat().st_size != frame.size_bytes:
            return False
        return hashlib.sha256(read_file(path, FileKind.IMAGE)).hexdigest() == frame.sha256

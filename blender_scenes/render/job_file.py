"""The packed file of a job for Blender: the same bytes for the same job; files that are not packed are read too."""

import gzip
import hashlib
import zlib
from pathlib import Path

from symolo.core.files.atomic_files import remove_file, write_file
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.layout import JOB, UNPACKED_JOB

_LEVEL = 6
"""Level of zlib; a job of 1.7 MB takes 0.02 s, and level 9 makes it smaller by 1 %."""
_GZIP_START = b"\x1f\x8b"
_GZIP_FORMAT = 31
"""Argument of zlib for a stream with the header and the checksum of gzip."""


def job_path(folder: Path) -> Path:
    """Return the file of a job in its folder; an earlier version of symolo wrote the text itself."""
    packed, unpacked = folder / JOB, folder / UNPACKED_JOB
    return unpacked if unpacked.is_file() and not packed.is_file() else packed


def write_job(folder: Path, text: str) -> None:
    """Write the text of a job into its folder, in place of any job that is there."""
    write_file(folder / JOB, gzip.compress(text.encode(), _LEVEL, mtime=0))
    remove_file(folder / UNPACKED_JOB)


def read_job(path: Path) -> bytes:
    """Return the text of a job from its file, packed or not.

    Raises:
        ValueError: The file is damaged, or its text is longer than a job may be.
        OSError: The file is missing or cannot be read.
    """
    data = read_file(path, FileKind.JOB)
    if not data.startswith(_GZIP_START):
        return data
    reader = zlib.decompressobj(_GZIP_FORMAT)
    try:
        text = reader.decompress(data, FileKind.JOB.max_bytes)
    except zlib.error as error:
        raise ValueError(f"{path}: the file is damaged: {error}") from error
    if not reader.eof or reader.unused_data:
        raise ValueError(f"{path}: the file is damaged, or the job is longer than {FileKind.JOB.max_bytes} bytes")
    return text


def job_sha256(path: Path) -> str:
    """Return the SHA-256 of the text of a job. For a damaged file it is that of its bytes, which belongs to no job."""
    try:
        text = read_job(path)
    except ValueError:
        text = read_file(path, FileKind.JOB)
    return hashlib.sha256(text).hexdigest()

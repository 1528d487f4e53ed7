"""OpenCV's decoder, whose own words about a damaged file stay unsaid: ours are one line."""

import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

import cv2
import numpy as np
from numpy.typing import NDArray

_SILENT = 0
_STDERR = 2


def decoded(data: bytes, flags: int, size: tuple[int, int], *, is_strict: bool = False) -> NDArray[np.generic]:
    """(H, W, 3), blue first, as OpenCV decodes it.

    Only one thread at a time may decode, and none may write to the standard error stream meanwhile.

    Args:
        data: A file's bytes.
        flags: OpenCV's, of `imread`.
        size: Width and height that the file tells; turned by its EXIF orientation they may be the other way round.
        is_strict: Whether anything that the decoder says refuses the file, as libjpeg decodes whatever it finds.

    Raises:
        ValueError: It cannot be decoded, or not to that size.
    """
    before = cv2.getLogLevel()  # pyright: ignore[reportAttributeAccessIssue]
    cv2.setLogLevel(_SILENT)  # pyright: ignore[reportAttributeAccessIssue]
    try:
        with _stderr_kept() as said:
            found = cv2.imdecode(np.frombuffer(data, np.uint8), flags)
            told = said.seek(0, os.SEEK_END) > 0
    except cv2.error:
        found, told = None, False
    finally:
        cv2.setLogLevel(before)  # pyright: ignore[reportAttributeAccessIssue]
    if found is None or found.shape[1::-1] not in {size, size[::-1]} or (is_strict and told):
        raise ValueError("is cut short or damaged: its pixels cannot be decoded")
    return found


@contextmanager
def unsaid() -> Iterator[None]:
    """Nothing that a decoder says reaches the terminal; nobody else may have anything to say there meanwhile."""
    with Path(os.devnull).open("wb") as nowhere, _stderr_into(nowhere):
        yield


@contextmanager
def _stderr_kept() -> Iterator[BinaryIO]:
    """A file that takes what is written to the standard error stream."""
    with tempfile.TemporaryFile() as said, _stderr_into(said):
        yield said


@contextmanager
def _stderr_into(said: BinaryIO) -> Iterator[None]:
    """By its descriptor: libpng and libjpeg go past OpenCV's log and past Python."""
    try:
        before = os.dup(_STDERR)
    except OSError:  # there is none
        yield
        return
    if sys.stderr is not None:
        sys.stderr.flush()
    os.dup2(said.fileno(), _STDERR)
    try:
        yield
    finally:
        os.dup2(before, _STDERR)
        os.close(before)

"""OpenCV's decoder without its messages about damaged files, in place of which we report one line."""

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
    """Return an image (H, W, 3), blue first, as OpenCV decodes it.

    Only one thread at a time may decode, and none may write to the standard error stream meanwhile.

    Args:
        data: The bytes of a file.
        flags: Flags of OpenCV's `imread`.
        size: Width and height in the file's header; its EXIF orientation may exchange them.
        is_strict: Whether any message of the decoder refuses the file, since libjpeg decodes damaged data too.

    Raises:
        ValueError: It cannot be decoded, or not to that size.
    """
    before = cv2.getLogLevel()  # pyright: ignore[reportAttributeAccessIssue]
    cv2.setLogLevel(_SILENT)  # pyright: ignore[reportAttributeAccessIssue]
    try:
        with _stderr_file() as messages:
            image = cv2.imdecode(np.frombuffer(data, np.uint8), flags)
            has_message = messages.seek(0, os.SEEK_END) > 0
    except cv2.error:
        image, has_message = None, False
    finally:
        cv2.setLogLevel(before)  # pyright: ignore[reportAttributeAccessIssue]
    if image is None or image.shape[1::-1] not in {size, size[::-1]} or (is_strict and has_message):
        raise ValueError("is cut short or damaged: its pixels cannot be decoded")
    return image


@contextmanager
def silenced() -> Iterator[None]:
    """Discard all messages of decoders; nothing else may write to the standard error stream meanwhile."""
    with Path(os.devnull).open("wb") as nowhere, _stderr_into(nowhere):
        yield


@contextmanager
def _stderr_file() -> Iterator[BinaryIO]:
    """Return a file that receives what is written to the standard error stream."""
    with tempfile.TemporaryFile() as messages, _stderr_into(messages):
        yield messages


@contextmanager
def _stderr_into(file: BinaryIO) -> Iterator[None]:
    """Redirect the descriptor of the standard error stream, which libpng and libjpeg use directly."""
    try:
        before = os.dup(_STDERR)
    except OSError:  # there is none
        yield
        return
    if sys.stderr is not None:
        sys.stderr.flush()
    os.dup2(file.fileno(), _STDERR)
    try:
        yield
    finally:
        os.dup2(before, _STDERR)
        os.close(before)

"""The child process of `image_decoder`: it reads images from its standard input, decodes them, and answers.

It needs next to nothing of the project, so it starts in the time that OpenCV takes to load.
"""

import os
import signal
import struct
import sys
from collections.abc import Callable
from enum import IntEnum
from typing import BinaryIO

import numpy as np

from symolo.core.process_limits import limit_memory, limit_time

READY = b"\x06"
"""The first byte of the child, once its libraries are loaded."""
COUNT = struct.Struct("<I")
"""Number of images in a batch; a request for each follows, and all are read before the first reply."""
REQUEST = struct.Struct("<iIIQ")
"""Flags of OpenCV's `imread`, width and height [px] of the header, number of bytes of the file, which follow."""
REPLY = struct.Struct("<BBBBII")
"""Outcome, whether the decoder printed anything, index in `DTYPES`, channels (0 where the image has two dimensions),
width and height [px]; the pixels follow."""
DTYPES = tuple(map(np.dtype, ("uint8", "uint16", "float32")))
SECONDS = 30
"""Processor time for the images that are sent together: one, or several small ones. The slowest image that
`image_headers` accepts takes two seconds."""
BYTES = 1_500_000_000
"""Memory beyond that of the child before its first image. The largest image that `image_headers` accepts takes a third
of it, and the largest panorama two thirds."""

Decode = Callable[[bytes, int], "np.ndarray | None"]


class DecodingOutcome(IntEnum):
    """Result of decoding an image."""

    DECODED = 0
    UNDECODABLE = 1
    NO_MEMORY = 2


def main() -> None:
    """Decode images with OpenCV until the owner ends or closes the pipe."""
    import cv2  # noqa: PLC0415 - the owner imports this module too, and does not need it

    cv2.setNumThreads(1)

    def decode(data: bytes, flags: int) -> np.ndarray | None:
        try:
            return cv2.imdecode(np.frombuffer(data, np.uint8), flags)
        except cv2.error as error:
            if error.code == cv2.Error.StsNoMem:
                raise MemoryError from error
            return None

    serve(decode)


def serve(decode: Decode, *, seconds: int = SECONDS, memory_bytes: int = BYTES) -> None:
    """Answer requests until the owner closes the pipe; the system ends this process if images take too long.

    Args:
        decode: Returns an image, or None where it is none.
        seconds: Time of the processor that the images of a request may take.
        memory_bytes: Memory that they may take.
    """
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):  # sent to all processes of a command, whose owner decides
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    requests, replies, messages = _streams()
    limit_memory(memory_bytes)
    replies.write(READY)
    replies.flush()
    while len(count := requests.read(COUNT.size)) == COUNT.size:
        batch = [_request(requests) for _ in range(*COUNT.unpack(count))]
        limit_time(seconds)
        for flags, size, data in batch:
            outcome, image = _decoded(decode, flags, size, data)
            has_message = _has_message(messages)
            if image is None:
                replies.write(REPLY.pack(outcome, has_message, 0, 0, 0, 0))
                continue
            form = DTYPES.index(image.dtype), image.shape[2] if image.ndim == 3 else 0, image.shape[1], image.shape[0]
            replies.write(REPLY.pack(outcome, has_message, *form))
            replies.write(image.data)
            del image  # or the next one would have to share the memory with it
        replies.flush()


def _request(requests: BinaryIO) -> tuple[int, tuple[int, int], bytes]:
    flags, width, height, count = REQUEST.unpack(requests.read(REQUEST.size))
    return flags, (width, height), requests.read(count)


def _decoded(
    decode: Decode, flags: int, size: tuple[int, int], data: bytes
) -> tuple[DecodingOutcome, "np.ndarray | None"]:
    try:
        image = decode(data, flags)
    except MemoryError:
        return DecodingOutcome.NO_MEMORY, None
    if image is None or image.dtype not in DTYPES or image.shape[1::-1] not in {size, size[::-1]}:
        return DecodingOutcome.UNDECODABLE, None
    return DecodingOutcome.DECODED, np.ascontiguousarray(image)


def _streams() -> tuple[BinaryIO, BinaryIO, int | None]:
    """Return the pipes to the owner, and one that receives what libraries print, for they use 1 and 2 directly."""
    requests, replies = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    messages = None
    null = os.open(os.devnull, os.O_RDWR)
    os.dup2(null, 0)
    if sys.platform == "win32":  # has no pipes that do not wait
        write = null
    else:
        messages, write = os.pipe()
        os.set_blocking(messages, False)
        os.set_blocking(write, False)
    os.dup2(write, 1)
    os.dup2(write, 2)
    return requests, replies, messages


def _has_message(messages: int | None) -> bool:
    """Return whether anything was printed since the last call."""
    try:
        return messages is not None and len(os.read(messages, 1 << 16)) > 0
    except BlockingIOError:
        return False

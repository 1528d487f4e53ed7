"""Decoding of untrusted images in a child process, with limits of processor time and memory.

A decoder is a large library in C that reads what somebody else wrote. If it crashes, does not end or takes all memory,
this is a fault of that one file, and the command goes on. The child starts with the first image and is replaced if it
ends. `image_headers` limits what comes here, so that ordinary decoders stay far below the limits.

The protocol is binary. `ChildProcess` exchanges JSON, in which an image would take longer to send than to decode.
"""

import atexit
import contextlib
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from io import FileIO
from pathlib import Path
from typing import cast

import numpy as np

from symolo.core.errors import EnvironmentLacking, one_line
from symolo.core.files.image_decoder_child import COUNT, DTYPES, READY, REPLY, REQUEST, DecodingOutcome
from symolo.core.os_errors import is_memory_limited

COLOUR = 1
"""(H, W, 3) of 8 bits, blue first; OpenCV's IMREAD_COLOR."""
AS_STORED = -1
"""The channels and the type of the file, in OpenCV's order; IMREAD_UNCHANGED."""
LIGHT = 3
"""(H, W, 3) in the type of the file, blue first; IMREAD_COLOR and IMREAD_ANYDEPTH."""

_PROGRAM = "import symolo.core.files.image_decoder_child as child; child.main()"
_ROOT = str(Path(__file__).parents[3])
_SETTINGS = {
    "OPENCV_LOG_LEVEL": "SILENT",
    "OPENBLAS_NUM_THREADS": "1",
    "MALLOC_MMAP_THRESHOLD_": str(32 << 20),
    "MALLOC_TRIM_THRESHOLD_": str(64 << 20),
}
"""Environment of the child. OpenCV 5 has no function for the first. Without the last two, glibc gives the memory of
each image back to the system. To get it again takes as long as to decode an image of 640 x 480 pixels."""
_CHANNELS = frozenset({0, 3, 4})
"""Possible numbers of channels of an image; 0 if it has two dimensions."""
_LAST_SECONDS = 5.0
"""Time in which a child ends after it has closed its pipes."""
_SHORTAGE = "images are decoded in a child process, and the system ended it, as it does where memory is short"


class Undecodable(ValueError):  # noqa: N818 - the word that says it
    """The decoder refuses the image, crashes on it, or exceeds its time or memory; the text says which."""


@dataclass(frozen=True)
class ImageFile:
    """An encoded image, and how it is to be decoded."""

    data: bytes
    flags: int
    """`COLOUR`, `AS_STORED` or `LIGHT`."""
    size: tuple[int, int]
    """Width and height [px] in the header; the EXIF orientation may exchange them."""


@dataclass(frozen=True)
class DecodedImage:
    """A decoded image."""

    pixels: np.ndarray
    """(H, W) or (H, W, channels)."""
    has_message: bool
    """Whether the decoder printed anything, which it does about damaged data that it decodes nevertheless."""


class ImageDecoder:
    """The child as its owner sees it; any thread may call `decode`."""

    def __init__(self, program: str = _PROGRAM) -> None:
        """Note the program of the child, which starts with the first image.

        Args:
            program: Program of the child, as `python -c` takes it.
        """
        self._program = program
        self._lock = threading.Lock()
        self._child: _Child | None = None

    def decode(self, images: Sequence[ImageFile]) -> list[DecodedImage | Undecodable]:
        """Return each image decoded, or why it is not. Sending several at once takes less time than one by one.

        Raises:
            MemoryError: The machine lacks the memory for it.
            EnvironmentLacking: The child cannot be started.
        """
        with self._lock:
            try:
                return self._answers(images)
            except Undecodable as error:
                if len(images) == 1:
                    return [error]
            return [self._answer(image) for image in images]  # one of them has ended the child

    def _answer(self, image: ImageFile) -> DecodedImage | Undecodable:
        try:
            return self._answers([image])[0]
        except Undecodable as error:
            return error

    def _answers(self, images: Sequence[ImageFile]) -> list[DecodedImage | Undecodable]:
        """Return the answers of a child; raise Undecodable where it ends before it has answered all."""
        if self._child is not None and not self._child.is_alive():  # somebody ended it between two images
            self._end()
        if self._child is None:
            self._child = _Child(self._program)
        try:
            return self._child.decode(images)
        except BrokenPipeError:
            reason = self._child.reason_of_end()
            self._end()
            raise reason from None
        except BaseException:  # such as of Ctrl-C, after which the next answers would be those to this call
            self._end()
            raise

    def close(self) -> None:
        """End the child, if there is one."""
        with self._lock:
            self._end()

    def forget(self) -> None:
        """Leave the child to the process that started it; for a copy of that process, made by fork."""
        self._lock = threading.Lock()  # another thread may have held the old one
        if self._child is not None:
            self._child.forget()
            self._child = None

    def _end(self) -> None:
        if self._child is not None:
            self._child.end()
            self._child = None


@cache
def _shared() -> ImageDecoder:
    """Return the decoder of this process."""
    decoder = ImageDecoder()
    atexit.register(decoder.close)
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(after_in_child=decoder.forget)
    return decoder


def decode_images(images: Sequence[ImageFile]) -> list[DecodedImage | Undecodable]:
    """Return each image decoded by the child of this process, or why it is not.

    Raises:
        MemoryError: The machine lacks the memory for it.
        EnvironmentLacking: The child cannot be started.
    """
    return _shared().decode(images)


class _Child:
    """One process, with its pipes."""

    def __init__(self, program: str) -> None:
        """Start it, and wait until it has loaded its libraries."""
        # Isolated: a module in the working folder, which may be a stranger's, must not take the place of a library.
        program = f"import sys; sys.path[:] = {[_ROOT, *filter(None, sys.path)]!r}; {program}"
        environment, pipe = {**os.environ, **_SETTINGS}, subprocess.PIPE
        command = [sys.executable, "-I", "-B", "-c", program]
        try:
            # Without buffers, which another thread may have filled or locked when this process is copied by fork.
            self._process = subprocess.Popen(command, 0, stdin=pipe, stdout=pipe, stderr=pipe, env=environment)
        except OSError as error:  # a reader would take an OSError for one of its file
            raise EnvironmentLacking(_not_started(str(error))) from error
        self._requests = cast("FileIO", self._process.stdin)
        self._replies = cast("FileIO", self._process.stdout)
        try:
            with cast("FileIO", self._process.stderr) as errors:
                is_ready = self._replies.read(len(READY)) == READY
                lines = [] if is_ready else errors.readall().decode(errors="replace").strip().splitlines()
        except BaseException:
            self.end()
            raise
        if not is_ready:
            self.end()
            raise EnvironmentLacking(_not_started(lines[-1] if lines else _how_ended(self._process.returncode)))

    def is_alive(self) -> bool:
        return self._process.poll() is None

    def decode(self, images: Sequence[ImageFile]) -> list[DecodedImage | Undecodable]:
        """Send images and return the answers.

        Raises:
            BrokenPipeError: The child has ended, or answers what it never would; it must be ended.
            MemoryError: The machine lacks the memory for it.
        """
        parts = [COUNT.pack(len(images))]
        for image in images:
            parts += [REQUEST.pack(image.flags, *image.size, len(image.data)), image.data]
        left = memoryview(b"".join(parts))
        while left:
            left = left[self._requests.write(left) :]
        return [self._answer(image.size) for image in images]

    def _answer(self, size: tuple[int, int]) -> DecodedImage | Undecodable:
        header = bytearray(REPLY.size)
        self._receive(memoryview(header))
        outcome, has_message, dtype, channels, width, height = REPLY.unpack(header)
        if outcome == DecodingOutcome.NO_MEMORY:
            if is_memory_limited():
                raise MemoryError(_SHORTAGE)
            return Undecodable("needs more memory than an image may")
        if outcome != DecodingOutcome.DECODED:
            return Undecodable("cannot be decoded")
        if (width, height) not in {size, size[::-1]} or channels not in _CHANNELS or dtype >= len(DTYPES):
            raise BrokenPipeError  # the decoder has been taken over
        pixels = np.empty((height, width, channels) if channels else (height, width), DTYPES[dtype])
        self._receive(pixels.reshape(-1).view(np.uint8).data)
        return DecodedImage(pixels, bool(has_message))

    def _receive(self, place: memoryview) -> None:
        """Fill some memory."""
        while place:
            count = self._replies.readinto(place)
            if not count:
                raise BrokenPipeError
            place = place[count:]

    def reason_of_end(self) -> Exception:
        """Return whose fault it is that the child has ended: that of the image, or that of the machine."""
        try:
            code = self._process.wait(_LAST_SECONDS)
        except subprocess.TimeoutExpired:
            return Undecodable("cannot be decoded: the decoder sent an invalid reply")
        # Where memory is limited, libraries crash that do not get any.
        was_killed = sys.platform != "win32" and code == -signal.SIGKILL
        if was_killed or is_memory_limited():
            return MemoryError(_SHORTAGE)
        return Undecodable(f"cannot be decoded: the decoder was ended by {_how_ended(code)}")

    def end(self) -> None:
        self._process.kill()
        self._close_pipes()
        self._process.wait()

    def forget(self) -> None:
        self._process.returncode = 0  # or Python would warn of a child that nobody waits for
        self._close_pipes()

    def _close_pipes(self) -> None:
        for pipe in (self._requests, self._replies):
            with contextlib.suppress(OSError):  # of what the child has not read any more
                pipe.close()


def _how_ended(code: int) -> str:
    return signal.Signals(-code).name if code < 0 else f"exit code {code}"


def _not_started(reason: str) -> str:
    cure = "free some memory and processes, see `symolo doctor`, and run the same command again"
    return one_line(f"images are decoded in a child process, which cannot be started: {reason}; {cure}")

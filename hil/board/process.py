"""The simulated board as a child process. It ends when its standard input closes, so it never outlives its owner."""

import contextlib
import os
import select
import subprocess
import tempfile
from pathlib import Path
from typing import Literal

from hil.board.build import build_board
from hil.closing import Closing
from hil.errors import BoardLost
from symolo.core.errors import one_line

Mode = Literal["lockstep", "pty"]
MCU, CLOCK_HZ = "atmega2560", 16_000_000
"""Processor of the Arduino Mega 2560."""
_PATIENCE_S = 30.0
"""Longest wait for one answer; the slowest firmware needs a hundredth of it."""
_END_S = 2.0
_MAX_READ = 1 << 16
"""Largest number of bytes in one read."""


class BoardProcess(Closing):
    """One running board; a context manager that ends it."""

    def __init__(self, mode: Mode, elf: Path, baud: int, *, program: Path | None = None) -> None:
        """Start a board.

        Args:
            mode: Whether it runs tick by tick on request, or in real time behind a pty.
            elf: The firmware.
            baud: Bits per second at this end of the serial line; the firmware sets its own.
            program: The simulated board; None builds it.

        Raises:
            EnvironmentLacking: The board is not built and cannot be.
            BoardLost: The firmware cannot be read.
        """
        command = [str(program or build_board()), mode, MCU, str(CLOCK_HZ), str(elf), str(baud)]
        self._log = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the process
        try:
            self._child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._log)
        except BaseException:
            self._log.close()
            raise
        self._buffer = b""
        self._pipes = [pipe for pipe in (self._child.stdin, self._child.stdout) if pipe is not None]

    @property
    def pid(self) -> int:
        return self._child.pid

    def write(self, request: bytes) -> None:
        to_board = self._pipes[0]
        try:
            to_board.write(request)
            to_board.flush()
        except (OSError, ValueError):
            raise self._gone() from None

    def read(self, length: int) -> bytes:
        """Return that many bytes of the board's answer.

        Raises:
            BoardLost: The firmware crashed, or the process ended or hangs.
        """
        out = self._pipes[1].fileno()
        while len(self._buffer) < length:
            ready, _, _ = select.select([out], [], [], _PATIENCE_S)
            if not ready:
                raise BoardLost(f"the simulated board has not answered for {_PATIENCE_S:.0f} s")
            piece = os.read(out, _MAX_READ)
            if not piece:
                raise self._gone()
            self._buffer += piece
        data, self._buffer = self._buffer[:length], self._buffer[length:]
        return data

    def expect(self, kind: bytes) -> None:
        """Read the letter with which the answer must begin.

        Raises:
            BoardLost: The answer is another one, such as why the board stopped.
        """
        letter = self._first()
        if letter != kind:
            raise BoardLost(f"the simulated board answers {letter!r} in place of {kind!r}")

    def read_line(self) -> str:
        """Return one line of text.

        Raises:
            BoardLost: The board reports why it stopped.
        """
        line = self._first()
        while not line.endswith(b"\n"):
            line += self.read(1)
        return line.decode().strip()

    def close(self) -> None:
        """End the process; may be called again."""
        for pipe in self._pipes:
            with contextlib.suppress(OSError):  # a dead child has not read everything
                pipe.close()
        try:
            self._child.wait(_END_S)
        except subprocess.TimeoutExpired:
            self._child.kill()
            self._child.wait()
        self._log.close()

    def _first(self) -> bytes:
        first = self.read(1)
        if first == b"E":
            raise _stopped(self.read(int.from_bytes(self.read(2), "little")))
        return first

    def _gone(self) -> BoardLost:
        """Return why a process that is gone has ended, from its last output."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._child.wait(_END_S)
            left = self._buffer + os.read(self._pipes[1].fileno(), _MAX_READ)
            if left.startswith(b"E"):
                return _stopped(left[3:])
        self._log.seek(0)
        last = self._log.read().decode(errors="replace").splitlines()[-1:]
        return BoardLost(
            one_line(f"the simulated board ended with status {self._child.poll()}: {last[0] if last else 'no message'}")
        )


def _stopped(why: bytes) -> BoardLost:
    return BoardLost(one_line(f"the simulated board stopped: {why.decode(errors='replace')}"))

"""The simulated board as a child process, which never outlives its owner: it ends when its standard input does."""

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
"""Of the Arduino Mega 2560."""
_PATIENCE_S = 30.0
"""For one answer, of which the slowest firmware takes a hundredth of that."""
_END_S = 2.0
_MOST = 1 << 16
"""Bytes that are read at once."""


class BoardProcess(Closing):
    """One running board; a context manager that ends it."""

    def __init__(self, mode: Mode, elf: Path, baud: int, *, program: Path | None = None) -> None:
        """Start a board.

        Args:
            mode: Whether it runs when told to, or in real time behind a pty.
            elf: The firmware.
            baud: Bits per second at this end of the serial line; the firmware sets those at its own.
            program: The simulated board; built if not given.

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
        self._heard = b""
        self._pipes = [pipe for pipe in (self._child.stdin, self._child.stdout) if pipe is not None]

    @property
    def pid(self) -> int:
        return self._child.pid

    def say(self, request: bytes) -> None:
        to_board = self._pipes[0]
        try:
            to_board.write(request)
            to_board.flush()
        except (OSError, ValueError):
            raise self._gone() from None

    def hear(self, length: int) -> bytes:
        """So many bytes of the board's answer.

        Raises:
            BoardLost: The firmware crashed, or the process ended or hangs.
        """
        out = self._pipes[1].fileno()
        while len(self._heard) < length:
            ready, _, _ = select.select([out], [], [], _PATIENCE_S)
            if not ready:
                raise BoardLost(f"the simulated board gives no answer for {_PATIENCE_S:.0f} s")
            piece = os.read(out, _MOST)
            if not piece:
                raise self._gone()
            self._heard += piece
        data, self._heard = self._heard[:length], self._heard[length:]
        return data

    def expect(self, kind: bytes) -> None:
        """The letter with which the answer must begin.

        Raises:
            BoardLost: The board says instead why it stopped.
        """
        found = self._first()
        if found != kind:
            raise BoardLost(f"the simulated board answers {found!r} where {kind!r} is due")

    def hear_line(self) -> str:
        """One line of text.

        Raises:
            BoardLost: The board says instead why it stopped.
        """
        line = self._first()
        while not line.endswith(b"\n"):
            line += self.hear(1)
        return line.decode().strip()

    def close(self) -> None:
        """End the process; may be called again."""
        for pipe in self._pipes:
            with contextlib.suppress(OSError):  # of what a dead child did not take
                pipe.close()
        try:
            self._child.wait(_END_S)
        except subprocess.TimeoutExpired:
            self._child.kill()
            self._child.wait()
        self._log.close()

    def _first(self) -> bytes:
        first = self.hear(1)
        if first == b"E":
            raise _stopped(self.hear(int.from_bytes(self.hear(2), "little")))
        return first

    def _gone(self) -> BoardLost:
        """What a process that is not there any more can still say."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._child.wait(_END_S)
            left = self._heard + os.read(self._pipes[1].fileno(), _MOST)
            if left.startswith(b"E"):
                return _stopped(left[3:])
        self._log.seek(0)
        last = self._log.read().decode(errors="replace").splitlines()[-1:]
        return BoardLost(
            one_line(f"the simulated board ended with status {self._child.poll()}: {last[0] if last else 'no word'}")
        )


def _stopped(why: bytes) -> BoardLost:
    return BoardLost(one_line(f"the simulated board stopped: {why.decode(errors='replace')}"))

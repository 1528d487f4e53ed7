"""The simulated board in lock-step: it runs the cycles of a tick in each tick, always alike, faster than real time."""

import struct
from pathlib import Path

import numpy as np

from hil.board.process import CLOCK_HZ, BoardProcess

_ANSWER = struct.Struct("<QIIH")


class LockstepLink:
    """Runs the board for one tick at the first `read` in it.

    The same bytes in the same ticks give the same bytes at the same cycles.
    """

    name = "simulated board in lock-step"

    def __init__(self, elf: Path, baud: int, *, program: Path | None = None) -> None:
        """Start a board; see `BoardProcess` for arguments and errors."""
        self._board = BoardProcess("lockstep", elf, baud, program=program)
        self._to_send = b""
        self._cycles_due = 0
        self.cycle = 0
        """Number of cycles since the board was switched on, at the end of the last tick."""
        self.arrivals: tuple[int, ...] = ()
        """Cycles from the beginning of the last tick to the arrival of each of its bytes."""
        self.overrun = 0
        """Number of bytes that the firmware lost because it read too late."""
        self.unheard = 0
        """Number of bytes that came while the firmware's receiver was off."""

    @property
    def pid(self) -> int:
        return self._board.pid

    def start_tick(self, tick_s: float) -> float:
        """Begin a tick. If the last one has not been run, run it now and drop what the board sends in it."""
        if self._cycles_due:
            self._run()
        self._cycles_due = round(tick_s * CLOCK_HZ)
        return 0.0

    def write(self, data: bytes) -> None:
        self._to_send += data

    def read(self) -> bytes:
        """Return all bytes that the board sends in this tick; empty at the next call."""
        return self._run() if self._cycles_due else b""

    def reset(self) -> None:
        """Press the board's reset button; bytes under way are lost."""
        self._board.write(b"R")
        self._board.expect(b"R")

    def close(self) -> None:
        self._board.close()

    def _run(self) -> bytes:
        sent, cycles = self._to_send, self._cycles_due
        self._to_send, self._cycles_due = b"", 0
        self._board.write(struct.pack("<cIH", b"T", cycles, len(sent)) + sent)
        self._board.expect(b"T")
        begin = self.cycle
        self.cycle, self.overrun, self.unheard, length = _ANSWER.unpack(self._board.read(_ANSWER.size))
        received = self._board.read(9 * length)
        self.arrivals = tuple(int(cycle) - begin for cycle in np.frombuffer(received[: 8 * length], dtype="<u8"))
        return received[8 * length :]

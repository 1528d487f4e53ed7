"""The simulated board in lock-step: it runs exactly a tick's cycles a tick, faster than real time, always the same."""

import struct
from pathlib import Path

import numpy as np

from hil.board.process import CLOCK_HZ, BoardProcess

_ANSWER = struct.Struct("<QIIH")


class LockstepLink:
    """Runs the board for one tick when its answer is first asked for.

    The same bytes in the same ticks give the same bytes at the same cycles.
    """

    name = "simulated board in lock-step"

    def __init__(self, elf: Path, baud: int, *, program: Path | None = None) -> None:
        """Start a board; see `BoardProcess` for arguments and errors."""
        self._board = BoardProcess("lockstep", elf, baud, program=program)
        self._to_send = b""
        self._cycles_due = 0
        self.cycle = 0
        """At the end of the last tick that was run, since the board was switched on."""
        self.arrivals: tuple[int, ...] = ()
        """Cycles since the tick began at which the bytes of the last tick had come in."""
        self.overrun = 0
        """Bytes that the firmware lost because it read too late."""
        self.unheard = 0
        """Bytes that came while the firmware's receiver was off."""

    @property
    def pid(self) -> int:
        return self._board.pid

    def start_tick(self, tick_s: float) -> float:
        """Begin a tick; what the board still has to run of the last one it runs now, and what it said then is lost."""
        if self._cycles_due:
            self._run()
        self._cycles_due = round(tick_s * CLOCK_HZ)
        return 0.0

    def write(self, data: bytes) -> None:
        self._to_send += data

    def read(self) -> bytes:
        """All that the board says in this tick; empty when asked again."""
        return self._run() if self._cycles_due else b""

    def reset(self) -> None:
        """Press the board's reset button; bytes under way are lost."""
        self._board.say(b"R")
        self._board.expect(b"R")

    def close(self) -> None:
        self._board.close()

    def _run(self) -> bytes:
        sent, cycles = self._to_send, self._cycles_due
        self._to_send, self._cycles_due = b"", 0
        self._board.say(struct.pack("<cIH", b"T", cycles, len(sent)) + sent)
        self._board.expect(b"T")
        began = self.cycle
        self.cycle, self.overrun, self.unheard, length = _ANSWER.unpack(self._board.hear(_ANSWER.size))
        heard = self._board.hear(9 * length)
        self.arrivals = tuple(int(at) - began for at in np.frombuffer(heard[: 8 * length], dtype="<u8"))
        return heard[8 * length :]

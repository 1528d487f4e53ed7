"""The simulated board in real time, with a pty for a serial port, for whatever program talks to a board."""

from pathlib import Path

from hil.board.process import BoardProcess
from hil.closing import Closing


class PtyBoard(Closing):
    """A board that runs while this object lives; `port` is opened like that of a real one."""

    def __init__(self, elf: Path, baud: int, *, program: Path | None = None) -> None:
        """Start a board; see `BoardProcess` for arguments and errors."""
        self._board = BoardProcess("pty", elf, baud, program=program)
        try:
            self.port = self._board.hear_line()
        except BaseException:
            self._board.close()
            raise

    @property
    def pid(self) -> int:
        return self._board.pid

    def reset(self) -> None:
        """Press the board's reset button."""
        self._board.say(b"R")

    def close(self) -> None:
        self._board.close()

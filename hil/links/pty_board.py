"""The simulated board in real time, with a pty as its serial port, for any program that talks to a board."""

from pathlib import Path

from hil.board.process import BoardProcess
from hil.closing import Closing


class PtyBoard(Closing):
    """A board that runs while this object lives; `port` is opened like the serial port of a real board."""

    def __init__(self, elf: Path, baud: int, *, program: Path | None = None) -> None:
        """Start a board; see `BoardProcess` for arguments and errors."""
        self._board = BoardProcess("pty", elf, baud, program=program)
        try:
            self.port = self._board.read_line()
        except BaseException:
            self._board.close()
            raise

    @property
    def pid(self) -> int:
        return self._board.pid

    def reset(self) -> None:
        """Press the board's reset button."""
        self._board.write(b"R")

    def close(self) -> None:
        self._board.close()

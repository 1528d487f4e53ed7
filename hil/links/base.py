"""The interface of a serial line to a board: it sends bytes, receives bytes and starts ticks."""

from typing import Protocol


class BoardLink(Protocol):
    """A line to a board. Ticks begin at equal distances of real or simulated time, as the link decides."""

    @property
    def name(self) -> str:
        """Name of the board in messages."""
        ...

    def start_tick(self, tick_s: float) -> float:
        """Wait until a tick of that length begins, and return by how much [s] it begins too late."""
        ...

    def write(self, data: bytes) -> None:
        """Send the data.

        Raises:
            BoardLost: The board is gone.
        """
        ...

    def read(self) -> bytes:
        """Wait for the next bytes of this tick; empty when an answer would come too late, also if bytes keep coming.

        Raises:
            BoardLost: The board is gone.
        """
        ...

    def close(self) -> None:
        """Close the line; may be called again."""
        ...

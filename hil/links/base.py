"""What a serial line to a board is to the loop: bytes out, bytes in, and when a tick begins."""

from typing import Protocol


class BoardLink(Protocol):
    """A line to a board. Ticks begin at equal distances; whether of real time is the link's affair."""

    @property
    def name(self) -> str:
        """Of the other end, for messages."""
        ...

    def start_tick(self, tick_s: float) -> float:
        """Wait until a tick of that length begins.

        Returns:
            By how much [s] it begins too late.
        """
        ...

    def write(self, data: bytes) -> None:
        """Send the data.

        Raises:
            BoardLost: There is nobody at the other end any more.
        """
        ...

    def read(self) -> bytes:
        """Wait for what comes next of this tick; empty when an answer to it would come too late.

        Raises:
            BoardLost: There is nobody at the other end any more.
        """
        ...

    def close(self) -> None:
        """Let go of the line; may be called again."""
        ...

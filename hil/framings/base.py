"""What a framing is: how frames become bytes on the line, and bytes of a bad line become frames again."""

from dataclasses import dataclass
from typing import Protocol

from hil.frames import CommandFrame, HelloFrame, SensorFrame


@dataclass(frozen=True)
class Damaged:
    """Bytes of which nothing could be made."""

    reason: str


@dataclass(frozen=True)
class CommandMessage:
    """A command that came in undamaged, as far as the framing can tell."""

    command: CommandFrame
    seq: int | None
    """Of the sensor frame that it answers; None where the framing does not say."""


@dataclass(frozen=True)
class SensorsMessage:
    """A sensor frame as the board hears it."""

    sensors: SensorFrame
    seq: int | None


@dataclass(frozen=True)
class HelloRequest:
    """The simulator wants to know who is there."""

    seq: int | None


FromBoard = CommandMessage | HelloFrame | Damaged
ToBoard = SensorsMessage | HelloRequest | Damaged


class BoardDecoder(Protocol):
    """Makes frames of what comes from the board, in pieces of any length; never raises, whatever comes."""

    def feed(self, data: bytes) -> list[FromBoard]: ...


class SimulatorDecoder(Protocol):
    """The same at the board's end; what the fake board hears with."""

    def feed(self, data: bytes) -> list[ToBoard]: ...


class Framing(Protocol):
    """One way to put frames on a serial line. Holds no state: what was heard so far is in the ears."""

    @property
    def name(self) -> str: ...

    @property
    def baud(self) -> int:
        """The rate at which it is used by default."""
        ...

    @property
    def numbers_frames(self) -> bool:
        """Whether an answer says which frame it answers, and a hello is understood."""
        ...

    def hello(self, seq: int) -> bytes:
        """Asks who is there; empty where the framing cannot."""
        ...

    def sensors(self, seq: int, frame: SensorFrame) -> bytes: ...

    def command(self, seq: int, frame: CommandFrame) -> bytes:
        """The board's answer, for boards that are not firmware."""
        ...

    def hello_answer(self, seq: int, frame: HelloFrame) -> bytes: ...

    def from_board(self) -> BoardDecoder: ...

    def to_board(self) -> SimulatorDecoder: ...

"""The interface of a framing, which encodes frames as bytes on the serial line and decodes also damaged bytes."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from hil.frames import CommandFrame, HelloFrame, SensorFrame


@dataclass(frozen=True)
class Damaged:
    """Bytes that are not a frame."""

    reason: str


@dataclass(frozen=True)
class CommandMessage:
    """A command without damage that the framing can detect."""

    command: CommandFrame
    seq: int | None
    """Sequence number of the sensor frame that it answers; None where the framing has no numbers."""


@dataclass(frozen=True)
class SensorsMessage:
    """A sensor frame as the board receives it."""

    sensors: SensorFrame
    seq: int | None


@dataclass(frozen=True)
class HelloRequest:
    """A request of the simulator for the identity of board and firmware."""

    seq: int | None


FromBoard = CommandMessage | HelloFrame | Damaged
ToBoard = SensorsMessage | HelloRequest | Damaged

Piece = TypeVar("Piece")
Received = TypeVar("Received")


class Splitter(Protocol[Piece]):
    """Cuts a stream of bytes into frames."""

    def split(self, data: bytes) -> list[Piece | Damaged]:
        """Return the frames that these bytes complete; the rest waits for further bytes."""
        ...


class Decoder(Generic[Received]):
    """Decodes bytes that arrive in pieces of any length. It never raises: bad bytes become `Damaged`."""

    def __init__(self, splitter: Splitter[Piece], parse: Callable[[Piece], Received | Damaged]) -> None:
        self._decode: Callable[[bytes], list[Received | Damaged]] = lambda data: [
            piece if isinstance(piece, Damaged) else parse(piece) for piece in splitter.split(data)
        ]

    def decode(self, data: bytes) -> list[Received | Damaged]:
        """Return what these bytes complete."""
        return self._decode(data)


BoardDecoder = Decoder[CommandMessage | HelloFrame]
"""Decodes what the board sends."""
SimulatorDecoder = Decoder[SensorsMessage | HelloRequest]
"""Decodes what the simulator sends, at the board's end."""


class Framing(Protocol):
    """One way to put frames on a serial line. It has no state; a decoder has."""

    @property
    def name(self) -> str: ...

    @property
    def baud(self) -> int:
        """Default baud rate."""
        ...

    @property
    def numbers_frames(self) -> bool:
        """Whether an answer names the frame that it answers, and a board can answer a hello."""
        ...

    def hello(self, seq: int) -> bytes:
        """Encode the request for the board's identity; empty where the framing has none."""
        ...

    def sensors(self, seq: int, frame: SensorFrame) -> bytes: ...

    def command(self, seq: int, frame: CommandFrame) -> bytes:
        """Encode the board's answer, for boards without the firmware."""
        ...

    def hello_answer(self, seq: int, frame: HelloFrame) -> bytes: ...

    def from_board(self) -> BoardDecoder: ...

    def to_board(self) -> SimulatorDecoder: ...

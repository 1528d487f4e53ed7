"""SimTwo's framing: one channel letter and eight upper-case hexadecimal digits, without number or checksum.

The letters are no hexadecimal digits, so a letter always begins a frame. Big endian. To the board R (encoder
increments right and left), I and J (line L0 to L3, L4 to L7), H (front and left range), K (right range, 0) and,
last, G (flags); from it s (state), M and Q (set points right and left), in that order.
"""

import string
import struct
from dataclasses import dataclass

from hil.frames import CommandFrame, HelloFrame, SensorFrame
from hil.framings import wire
from hil.framings.base import (
    BoardDecoder,
    CommandMessage,
    Damaged,
    Decoder,
    FromBoard,
    SensorsMessage,
    SimulatorDecoder,
    ToBoard,
)

LETTERS = frozenset((string.ascii_uppercase[6:] + string.ascii_lowercase[6:]).encode())
DIGITS = frozenset(b"0123456789ABCDEF")
VALUE_DIGITS = 8
_FROM_BOARD, _TO_BOARD = "sMQ", "RIJHKG"
_RUN, _START = 1, 2
"""Bits of G: run; forget state, odometry and counters first."""


@dataclass(frozen=True)
class SimTwo:
    """Framing of SimTwo. A digit that changes into another one is not detected; see docs/hil_protocol.md."""

    name: str = "simtwo"
    baud: int = 115_200
    numbers_frames: bool = False

    def hello(self, seq: int) -> bytes:
        del seq
        return b""

    def sensors(self, seq: int, frame: SensorFrame) -> bytes:
        del seq
        line = wire.line_bytes(frame.line)
        values = (
            struct.pack(">hh", *wire.increments(frame)),
            line[:4],
            line[4:],
            struct.pack(">HH", wire.range_mm(frame.front_m), wire.range_mm(frame.left_m)),
            struct.pack(">HH", wire.range_mm(frame.right_m), 0),
            struct.pack(">I", _RUN * frame.run + _START * frame.start),
        )
        return b"".join(_frame(letter, value) for letter, value in zip(_TO_BOARD, values, strict=True))

    def command(self, seq: int, frame: CommandFrame) -> bytes:
        del seq
        set_points = (struct.pack(">i", wire.milli(speed, 32)) for speed in (frame.right_rad_s, frame.left_rad_s))
        values = (struct.pack(">I", int(frame.state)), *set_points)
        return b"".join(_frame(letter, value) for letter, value in zip(_FROM_BOARD, values, strict=True))

    def hello_answer(self, seq: int, frame: HelloFrame) -> bytes:
        del seq, frame
        return b""

    def from_board(self) -> BoardDecoder:
        return Decoder(_Channels(_FROM_BOARD), _from_board)

    def to_board(self) -> SimulatorDecoder:
        return Decoder(_Channels(_TO_BOARD), _to_board)


def _frame(letter: str, value: bytes) -> bytes:
    return (letter + value.hex().upper()).encode()


class _Channels:
    """Cuts the stream into single frames and collects those of one tick, which end with the last letter."""

    def __init__(self, letters: str) -> None:
        self._letters = letters.encode()
        self._letter = 0
        self._digits = bytearray()
        self._values: dict[int, bytes] = {}
        self._lost = False

    def split(self, data: bytes) -> list[tuple[bytes, ...] | Damaged]:
        """Return the values of each tick that is complete, in the order of the letters."""
        return [piece for byte in data for piece in self._take(byte)]

    def _take(self, byte: int) -> list[tuple[bytes, ...] | Damaged]:
        damage: list[tuple[bytes, ...] | Damaged] = []
        if byte in LETTERS:
            if self._letter:
                damage.append(self._dropped("a frame that ends too early"))
            self._letter, self._lost = byte, False
            self._digits.clear()
        elif byte in DIGITS and self._letter:
            self._digits.append(byte)
            if len(self._digits) == VALUE_DIGITS:
                return self._whole()
        elif not self._lost:
            damage.append(self._dropped("a character that belongs to no frame"))
            self._lost = True
        return damage

    def _dropped(self, reason: str) -> Damaged:
        self._letter = 0
        self._values.clear()
        return Damaged(reason)

    def _whole(self) -> list[tuple[bytes, ...] | Damaged]:
        letter, self._letter = self._letter, 0
        if letter not in self._letters:
            return []  # a channel that is not ours
        place = self._letters.index(letter)
        if place == 0:
            self._values.clear()
        elif len(self._values) != place:
            self._values.clear()
            return [Damaged(f"{chr(letter)} without the channels that come before it")]
        self._values[letter] = bytes.fromhex(self._digits.decode())
        if len(self._values) < len(self._letters):
            return []
        whole = tuple(self._values.values())
        self._values.clear()
        return [whole]


def _from_board(values: tuple[bytes, ...]) -> FromBoard:
    number, right, left = (int.from_bytes(value, "big", signed=True) for value in values)
    state = wire.state_from(number)
    if state is None:
        return Damaged(f"there is no state {number}")
    return CommandMessage(CommandFrame(state, right / 1000.0, left / 1000.0), None)


def _to_board(values: tuple[bytes, ...]) -> ToBoard:
    increments, line_low, line_high, front_left, right_range, flag_bits = values
    front_mm, left_mm = struct.unpack(">HH", front_left)
    right_mm, _ = struct.unpack(">HH", right_range)
    front_m, left_m, right_m = (wire.range_from(mm) for mm in (front_mm, left_mm, right_mm))
    right, left = struct.unpack(">hh", increments)
    flags = int.from_bytes(flag_bits, "big")
    line = wire.line_from(line_low + line_high)
    return SensorsMessage(
        SensorFrame((right, left), line, front_m, left_m, right_m, bool(flags & _RUN), bool(flags & _START)), None
    )

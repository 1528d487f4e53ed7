"""The default framing: a length fixed by the type, sequence number, CRC-16, byte stuffing, zeros between frames.

Frame: COBS(type u8, seq u8, payload, crc u16) 0x00, little endian; the CRC is CRC-16/IBM-3740 over type to payload. A
zero precedes it too, so that noise on the line does not become part of it; two zeros in a row are no empty frame.
"""

import binascii
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
    HelloRequest,
    SensorsMessage,
    SimulatorDecoder,
    ToBoard,
)
from hil.framings.cobs import stuffed, unstuffed

SENSORS, COMMAND, HELLO, HELLO_ANSWER = 0x53, 0x43, 0x48, 0x68
_RUN, _START, _SUM_FROM = 1, 2, 2
_SENSORS = struct.Struct("<Bhh8sHHH")
_COMMAND = struct.Struct("<BhhhhHHB")
_HELLO_ANSWER = struct.Struct("<B8sB")
_CRC_INITIAL = 0xFFFF
_LENGTHS = {SENSORS: _SENSORS.size, COMMAND: _COMMAND.size, HELLO: 0, HELLO_ANSWER: _HELLO_ANSWER.size}
_LONGEST = max(_LENGTHS.values()) + 2 + 2 + 1
"""Largest length [byte] of a stuffed frame without its zero."""


def crc16(data: bytes) -> int:
    """Return CRC-16/IBM-3740: polynomial 0x1021, initial value 0xFFFF, nothing reflected."""
    return binascii.crc_hqx(data, _CRC_INITIAL)


@dataclass(frozen=True)
class Framed:
    """Frames with a checksum; docs/hil_protocol.md lists how often damage is not detected."""

    name: str = "framed"
    baud: int = 500_000
    numbers_frames: bool = True

    def hello(self, seq: int) -> bytes:
        return _frame(HELLO, seq, b"")

    def sensors(self, seq: int, frame: SensorFrame) -> bytes:
        ranges = (wire.range_mm(range_m) for range_m in (frame.front_m, frame.left_m, frame.right_m))
        rest = _SENSORS.pack(0, *wire.increments(frame), wire.line_bytes(frame.line), *ranges)[1:]
        flags = _RUN * frame.run + _START * frame.start + (_sum(seq, rest) << _SUM_FROM)
        return _frame(SENSORS, seq, bytes([flags]) + rest)

    def command(self, seq: int, frame: CommandFrame) -> bytes:
        speeds = (frame.right_rad_s, frame.left_rad_s, frame.v_m_s or 0.0, frame.w_rad_s or 0.0)
        counts = (frame.line_lost or 0, frame.ticks or 0, frame.dropped or 0)
        return _frame(
            COMMAND, seq, _COMMAND.pack(int(frame.state), *(wire.milli(speed, 16) for speed in speeds), *counts)
        )

    def hello_answer(self, seq: int, frame: HelloFrame) -> bytes:
        payload = _HELLO_ANSWER.pack(frame.protocol, bytes.fromhex(frame.firmware_id), frame.baud_index)
        return _frame(HELLO_ANSWER, seq, payload)

    def from_board(self) -> BoardDecoder:
        return Decoder(_Splitter(), _from_board)

    def to_board(self) -> SimulatorDecoder:
        return Decoder(_Splitter(), _to_board)


def _sum(seq: int, rest: bytes) -> int:
    """Return six more bits against damage: the board has nothing else to judge sensor readings by."""
    return (seq + sum(rest)) & 0x3F


def _frame(kind: int, seq: int, payload: bytes) -> bytes:
    body = bytes([kind, seq & 0xFF]) + payload
    return b"\0" + stuffed(body + struct.pack("<H", crc16(body))) + b"\0"


@dataclass(frozen=True)
class _Whole:
    kind: int
    seq: int
    payload: bytes


class _Splitter:
    """Cuts the stream at its zeros; what lies between two zeros is a frame or is dropped."""

    def __init__(self) -> None:
        self._buffer = bytearray()
        self._too_long = False

    def split(self, data: bytes) -> list[_Whole | Damaged]:
        # A piece before a zero ends a frame that may have begun in earlier data.
        *ended, rest = data.split(b"\0")
        frames = [self._end(piece) for piece in ended]
        self._append(rest)
        return [frame for frame in frames if frame is not None]

    def _append(self, piece: bytes) -> None:
        self._buffer += piece
        if len(self._buffer) > _LONGEST:
            self._too_long = True
            self._buffer.clear()

    def _end(self, piece: bytes) -> _Whole | Damaged | None:
        self._append(piece)
        stuffed_frame, too_long = bytes(self._buffer), self._too_long
        self._buffer.clear()
        self._too_long = False
        if too_long:
            return Damaged("longer than any frame")
        return _unpacked(stuffed_frame) if stuffed_frame else None


def _unpacked(stuffed_frame: bytes) -> _Whole | Damaged:
    body = unstuffed(stuffed_frame)
    if body is None or len(body) < 4:
        return Damaged("no frame")
    if _LENGTHS.get(body[0]) != len(body) - 4:
        return Damaged("no frame of that type and length")
    if crc16(body[:-2]) != int.from_bytes(body[-2:], "little"):
        return Damaged("wrong checksum")
    return _Whole(body[0], body[1], body[2:-2])


def _from_board(frame: _Whole) -> FromBoard:
    if frame.kind == HELLO_ANSWER:
        protocol, identity, baud_index = _HELLO_ANSWER.unpack(frame.payload)
        return HelloFrame(protocol, identity.hex(), baud_index)
    if frame.kind != COMMAND:
        return Damaged("a frame that a board does not send")
    number, right, left, v, w, line_lost, ticks, dropped = _COMMAND.unpack(frame.payload)
    state = wire.state_from(number)
    if state is None:
        return Damaged(f"there is no state {number}")
    speeds = (right / 1000.0, left / 1000.0, v / 1000.0, w / 1000.0)
    return CommandMessage(CommandFrame(state, *speeds, line_lost, ticks, dropped), frame.seq)


def _to_board(frame: _Whole) -> ToBoard:
    if frame.kind == HELLO:
        return HelloRequest(frame.seq)
    if frame.kind != SENSORS:
        return Damaged("a frame that a simulator does not send")
    flags, right, left, line, *ranges = _SENSORS.unpack(frame.payload)
    if flags >> _SUM_FROM != _sum(frame.seq, frame.payload[1:]):
        return Damaged("sensors that do not add up")
    front_m, left_m, right_m = (wire.range_from(mm) for mm in ranges)
    sensors = SensorFrame(
        (right, left), wire.line_from(line), front_m, left_m, right_m, bool(flags & _RUN), bool(flags & _START)
    )
    return SensorsMessage(sensors, frame.seq)

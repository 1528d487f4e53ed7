"""Numbers as they go over the line: rounded, kept within what the bits hold, the same for every framing."""

from hil.frames import CHANNELS, MAX_INCREMENT, SensorFrame
from symolo.dataset.codes import State

MISSING_MM = 65535
"""Stands for a range sensor that is not there."""
_STATES = {int(state): state for state in State}


def line_bytes(line: tuple[float, ...]) -> bytes:
    """The channels, one byte each, 255 for 1.0."""
    if len(line) != CHANNELS:
        raise ValueError(f"a line sensor of {len(line)} channels; the frame has {CHANNELS}")
    return bytes(_held(255.0 * value, 0, 255) for value in line)


def line_from(data: bytes) -> tuple[float, ...]:
    return tuple(value / 255.0 for value in data)


def range_mm(range_m: float | None) -> int:
    return MISSING_MM if range_m is None else _held(1000.0 * range_m, 0, MISSING_MM - 1)


def range_from(mm: int) -> float | None:
    return None if mm == MISSING_MM else mm / 1000.0


def milli(value: float, bits: int) -> int:
    """A signed number in thousandths, held within `bits`."""
    return _held(1000.0 * value, -(1 << (bits - 1)), (1 << (bits - 1)) - 1)


def increments(frame: SensorFrame) -> tuple[int, int]:
    """Both encoder increments.

    Raises:
        ValueError: They do not fit in 16 bits, as no wheel turns in a tick.
    """
    right, left = frame.encoder_increments
    if max(abs(right), abs(left)) > MAX_INCREMENT:
        raise ValueError(f"encoder increments {right}, {left} do not fit in 16 bits")
    return right, left


def state_from(number: int) -> State | None:
    """The state with that number of data.csv, or None."""
    return _STATES.get(number)


def _held(value: float, least: int, most: int) -> int:
    return max(least, min(most, round(value)))

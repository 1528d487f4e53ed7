"""Numbers on the serial line: rounded and clipped to what the bits hold, the same for every framing."""

from hil.frames import CHANNELS, MAX_INCREMENT, SensorFrame
from symolo.dataset.codes import State

MISSING_MM = 65535
"""Code of a missing range sensor."""
_STATES = {int(state): state for state in State}


def line_bytes(line: tuple[float, ...]) -> bytes:
    """Return the channels of the line sensor, one byte each, 255 for 1.0."""
    if len(line) != CHANNELS:
        raise ValueError(f"a line sensor of {len(line)} channels; the frame has {CHANNELS}")
    return bytes(_clipped(255.0 * value, 0, 255) for value in line)


def line_from(data: bytes) -> tuple[float, ...]:
    return tuple(value / 255.0 for value in data)


def range_mm(range_m: float | None) -> int:
    return MISSING_MM if range_m is None else _clipped(1000.0 * range_m, 0, MISSING_MM - 1)


def range_from(mm: int) -> float | None:
    return None if mm == MISSING_MM else mm / 1000.0


def milli(value: float, bits: int) -> int:
    """Return a signed number in thousandths, clipped to `bits`."""
    return _clipped(1000.0 * value, -(1 << (bits - 1)), (1 << (bits - 1)) - 1)


def increments(frame: SensorFrame) -> tuple[int, int]:
    """Return both encoder increments.

    Raises:
        ValueError: They do not fit in 16 bits; no wheel turns so far in a tick.
    """
    right, left = frame.encoder_increments
    if max(abs(right), abs(left)) > MAX_INCREMENT:
        raise ValueError(f"encoder increments {right}, {left} do not fit in 16 bits")
    return right, left


def state_from(number: int) -> State | None:
    """Return the state with that number in data.csv, or None."""
    return _STATES.get(number)


def _clipped(value: float, low: int, high: int) -> int:
    return max(low, min(high, round(value)))

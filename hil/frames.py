"""What simulator and board tell each other, in SI units, whatever the framing on the wire."""

from dataclasses import dataclass

from symolo.dataset.codes import State

CHANNELS = 8
"""Of the line sensor."""
MAX_INCREMENT = 32767
"""That 16 bits hold either way."""


@dataclass(frozen=True)
class SensorFrame:
    """What the robot's sensors say at one tick, for the board.

    On the wire a channel of the line is one byte, a range a whole number of millimetres, an encoder increment 16 bits.
    """

    encoder_increments: tuple[int, int]
    """Counts right and left since the frame before, each at most `MAX_INCREMENT` either way."""
    line: tuple[float, ...]
    """Normalised reflectance L0 to L7, right to left, 0 to 1."""
    front_m: float | None
    left_m: float | None
    right_m: float | None
    """Ranges as the sensors give them, with the no-target value where there is no target; None where a sensor is
    missing."""
    run: bool = True
    """False: the board is to stand still; it keeps state and odometry."""
    start: bool = False
    """True: the board is to forget state, odometry and counters first."""


@dataclass(frozen=True)
class CommandFrame:
    """What the board answers to one `SensorFrame`. None where the framing has no place for it."""

    state: State
    right_rad_s: float
    left_rad_s: float
    """Set points of the wheels."""
    v_m_s: float | None = None
    w_rad_s: float | None = None
    """Speeds from which the set points were made."""
    line_lost: int | None = None
    """Ticks in the line state without a channel on the line."""
    ticks: int | None = None
    """Sensor frames that the board took since it booted, at most 65535."""
    dropped: int | None = None
    """Damaged frames that the board heard since its last answer, at most 255."""


@dataclass(frozen=True)
class HelloFrame:
    """Who is at the other end."""

    protocol: int
    """Version of the wire format."""
    firmware_id: str
    """The first eight bytes of the SHA-256 of what the firmware was built from, as 16 hexadecimal digits."""
    baud_index: int
    """Into the table of baud rates that firmware is built for."""

"""Frames that simulator and board exchange, in SI units, independent of the framing on the wire."""

from dataclasses import dataclass

from symolo.dataset.codes import State

CHANNELS = 8
"""Number of channels of the line sensor."""
MAX_INCREMENT = 32767
"""Largest encoder increment, forwards or backwards, in 16 bits."""


@dataclass(frozen=True)
class SensorFrame:
    """The readings of the robot's sensors at one tick, for the board.

    On the wire a channel of the line is one byte, a range is in whole millimetres, an encoder increment has 16 bits.
    """

    encoder_increments: tuple[int, int]
    """Encoder counts right and left since the frame before, each at most `MAX_INCREMENT` forwards or backwards."""
    line: tuple[float, ...]
    """Normalised reflectance L0 to L7, right to left, 0 to 1."""
    front_m: float | None
    left_m: float | None
    right_m: float | None
    """Ranges [m] as the sensors report them, with the no-target value where there is no target; None for a missing
    sensor."""
    run: bool = True
    """Whether the robot may drive; else it stops, and state and odometry do not change."""
    start: bool = False
    """Whether the board resets state, odometry and counters first."""


@dataclass(frozen=True)
class CommandFrame:
    """The board's answer to one `SensorFrame`. A field is None where the framing has no place for it."""

    state: State
    right_rad_s: float
    left_rad_s: float
    """Set points [rad/s] of the wheels."""
    v_m_s: float | None = None
    w_rad_s: float | None = None
    """Forward speed [m/s] and yaw rate [rad/s] that the set points follow from."""
    line_lost: int | None = None
    """Number of ticks in the line state without a channel on the line."""
    ticks: int | None = None
    """Number of sensor frames that the board received since it booted, at most 65535."""
    dropped: int | None = None
    """Number of damaged frames that the board received since its last answer, at most 255."""


@dataclass(frozen=True)
class HelloFrame:
    """The identity of the board and of its firmware."""

    protocol: int
    """Version of the wire format."""
    firmware_id: str
    """First eight bytes of the SHA-256 of the firmware's sources, as 16 hexadecimal digits."""
    baud_index: int
    """Index into the table of baud rates that firmware is built for."""

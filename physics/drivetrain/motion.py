"""What friction looks at."""

from dataclasses import dataclass

from symolo.core.arrays import Array


@dataclass(frozen=True)
class Motion:
    direction: Array
    """Of the motion, or at rest of the torque that would set the wheel in motion: -1, 0 or +1."""
    speed_rad_s: Array
    time_s: float | Array
    """Since the motor was first switched on."""

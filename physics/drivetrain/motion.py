"""State of a shaft that friction depends on."""

from dataclasses import dataclass

from symolo.core.arrays import Array


@dataclass(frozen=True)
class ShaftMotion:
    direction: Array
    """Direction of the motion, at rest of the torque that would start it: -1, 0 or +1."""
    speed_rad_s: Array
    time_s: float | Array
    """Time since the motor was first switched on."""

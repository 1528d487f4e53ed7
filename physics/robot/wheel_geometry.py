"""Wheel radii and track, which relate wheel speeds to the motion of the body."""

from dataclasses import dataclass

from configs.schema.robot import Drive


@dataclass(frozen=True)
class WheelGeometry:
    """Radii and track of one robot, or arrays of them for many robots."""

    right_radius_m: float
    """Rolling radius of the right wheel."""
    left_radius_m: float
    """Rolling radius of the left wheel."""
    track_m: float
    """Distance between the two ground contact points (paper Eq. 2)."""

    @classmethod
    def from_config(cls, drive: Drive) -> "WheelGeometry":
        radius_m = 0.5 * drive.wheel_diameter_m
        return cls(radius_m, radius_m, drive.track_m)

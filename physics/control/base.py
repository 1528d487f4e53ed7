"""What the controller reads and what it commands."""

from dataclasses import dataclass
from typing import Literal

from symolo.dataset.codes import State

Side = Literal["left", "right"]
Pose = tuple[float, float, float]
"""x [m], y [m], yaw [rad]."""


def other(side: Side) -> Side:
    return "right" if side == "left" else "left"


def sign_of(side: Side) -> float:
    """+1 left, -1 right: the direction in which y and yaw grow."""
    return 1.0 if side == "left" else -1.0


@dataclass(frozen=True)
class ControlInput:
    """What the robot knows at one control tick."""

    line: tuple[float, ...]
    """Normalised reflectance L0...L7, right to left."""
    front_m: float
    left_m: float
    right_m: float
    """Ranges; the no-target value where there is none."""
    odometry: Pose
    """By the wheels, in the frame of the start."""

    def side_m(self, side: Side) -> float:
        return self.left_m if side == "left" else self.right_m


@dataclass(frozen=True)
class Command:
    """What the robot wants to do until the next tick."""

    v_m_s: float
    w_rad_s: float
    state: State

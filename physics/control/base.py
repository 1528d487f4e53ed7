"""Inputs and outputs of the controller."""

from dataclasses import dataclass
from typing import Literal

from symolo.core.geometry.poses import PlanarPose
from symolo.dataset.codes import State

Side = Literal["left", "right"]


def other(side: Side) -> Side:
    return "right" if side == "left" else "left"


def sign_of(side: Side) -> float:
    """Return +1 for left and -1 for right, as y and yaw grow to the left."""
    return 1.0 if side == "left" else -1.0


@dataclass(frozen=True)
class ControlInput:
    """Sensor readings and odometry at one control tick."""

    line: tuple[float, ...]
    """(8,), normalised reflectance of the channels L0 to L7, from right to left."""
    front_m: float
    left_m: float
    right_m: float
    """Range of each sensor; the configured no-target value if it sees nothing."""
    odometry: PlanarPose
    """PlanarPose estimated from the wheels, in the frame of the start."""

    def side_m(self, side: Side) -> float:
        return self.left_m if side == "left" else self.right_m


@dataclass(frozen=True)
class Command:
    """Motion that the controller commands until the next tick."""

    v_m_s: float
    w_rad_s: float
    state: State

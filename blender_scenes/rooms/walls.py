"""The four walls of a rectangular room as frames."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from blender_scenes.scene.description import Point2, Point3
from symolo.core.poses import PlanarPose

WallSide = Literal["east", "north", "west", "south"]
SIDES: dict[WallSide, Point3] = {
    "east": (1.0, 0.0, 0.0),
    "north": (0.0, 1.0, 0.0),
    "west": (-1.0, 0.0, 0.0),
    "south": (0.0, -1.0, 0.0),
}
"""Outward normal of each side's wall."""


@dataclass(frozen=True, eq=False)
class RoomWall:
    """The inner face of a wall; its coordinates are the distance to the right of its middle and the height [m]."""

    side: WallSide
    foot: NDArray[np.float64]
    """(3,) middle of its lower edge [m]."""
    right: NDArray[np.float64]
    """(3,) unit vector to the right as seen from inside."""
    outward: NDArray[np.float64]
    """(3,) unit normal out of the room."""
    length_m: float

    def pose(self, along_m: float, before_m: float) -> PlanarPose:
        """Return the pose of a frame `before_m` in front of the face, with x to the right and y into the wall."""
        at = self.foot + self.right * along_m - self.outward * before_m
        return float(at[0]), float(at[1]), float(np.arctan2(self.right[1], self.right[0]))


def wall(side: WallSide, low: Point2, high: Point2) -> RoomWall:
    """Return the wall on one side of the room between two corners."""
    outward = np.array(SIDES[side])
    right = np.array([outward[1], -outward[0], 0.0])
    half = 0.5 * np.subtract(high, low)
    middle = 0.5 * np.add(low, high)
    foot = np.array([*middle, 0.0]) + outward * abs(float(outward[:2] @ half))
    return RoomWall(side, foot, right, outward, 2 * abs(float(right[:2] @ half)))

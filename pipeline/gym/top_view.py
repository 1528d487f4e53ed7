"""An arena from above with its robot, quickly drawn, for people who watch an agent."""

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from symolo.arena.footprints import Rectangle
from symolo.arena.geometry import Arena, Box
from symolo.core.arrays import Array
from symolo.core.geometry.poses import PlanarPose

SIZE_PX = 480
MARGIN_M = 0.2
_FLOOR, _LINE, _WALL, _OBSTACLE, _ROBOT, _NOSE = (
    *((235, 235, 230), (30, 30, 30), (120, 120, 130), (190, 120, 60)),
    *((40, 90, 180), (255, 255, 255)),
)
_SHIFT = 4
"""Binary digits of a pixel that the drawing resolves."""


class TopView:
    """Draws one arena; x to the right, y up."""

    def __init__(self, arena: Arena, robot: RobotConfig) -> None:
        self._boxes = arena.boxes
        chassis = robot.chassis
        self._size_m = (chassis.length_m, chassis.width_m)
        edges = [np.concatenate([left, right[::-1]]) for left, right in arena.line.edges()]
        points = np.concatenate([*edges, *(box.footprint() for box in arena.boxes), np.zeros((1, 2))])
        low, high = points.min(axis=0) - MARGIN_M, points.max(axis=0) + MARGIN_M
        self._scale = SIZE_PX / float((high - low).max())
        self._corner = 0.5 * (low + high) - 0.5 * SIZE_PX / self._scale
        self._background = np.full((SIZE_PX, SIZE_PX, 3), _FLOOR, np.uint8)
        for edge in edges:
            self._fill(self._background, edge, _LINE)
        for box in arena.boxes:
            if box.motion is None:
                self._fill(self._background, box.footprint(), _colour(box))

    def image(self, pose: PlanarPose, time_s: float) -> NDArray[np.uint8]:
        """Return (480, 480, 3), red, green, blue, with the robot at a pose."""
        image = self._background.copy()
        for box in self._boxes:
            if box.motion is not None:
                x, y, yaw = box.poses_at(np.array([time_s]))[0].tolist()
                self._fill(image, np.array(Rectangle((x, y), box.size[:2], yaw).corners()), _colour(box))
        x, y, yaw = pose
        self._fill(image, np.array(Rectangle((x, y), self._size_m, yaw).corners()), _ROBOT)
        ahead_m = 0.35 * self._size_m[0]
        nose = np.array([[x, y], [x + ahead_m * math.cos(yaw), y + ahead_m * math.sin(yaw)]])
        cv2.polylines(image, [self._pixels(nose)], False, _NOSE, 2, cv2.LINE_AA, _SHIFT)  # noqa: FBT003 - of OpenCV
        return image

    def _fill(self, image: NDArray[np.uint8], outline: Array, colour: tuple[int, int, int]) -> None:
        cv2.fillPoly(image, [self._pixels(outline)], colour, cv2.LINE_AA, _SHIFT)

    def _pixels(self, points: Array) -> NDArray[np.int32]:
        placed = (points - self._corner) * self._scale
        placed[:, 1] = SIZE_PX - placed[:, 1]
        return np.rint(placed * 2**_SHIFT).astype(np.int32)


def _colour(box: Box) -> tuple[int, int, int]:
    return _WALL if box.kind == "wall" else _OBSTACLE

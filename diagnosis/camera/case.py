"""Pictures with poses, and the camera and the map that they are held against."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from configs.schema.look import LookConfig
from configs.schema.robot import Camera, RobotConfig
from physics.robot.path import RobotPath
from sensors.camera.response import CameraResponse
from symolo.arena.geometry import Arena

Mask = NDArray[np.bool_]
Ints = NDArray[np.int64]
Picture = NDArray[np.uint8]

HELD_OUT_EACH = 4
"""Of the pictures, every fourth fits nothing."""


@dataclass(frozen=True)
class PoseErrors:
    """Standard deviations of the poses that come with the pictures, each picture's by itself."""

    position_m: float = 0.0005
    yaw_deg: float = 0.1


@dataclass(frozen=True)
class Frame:
    """One measured picture."""

    number: int
    t_s: float
    picture: Picture
    """(H, W, 3) RGB."""
    simulated: Picture | None
    """(H, W, 3) RGB, of the nominal camera in the same place; None where there is none."""
    heldout: bool


@dataclass(frozen=True)
class PictureCase:
    name: str
    frames: tuple[Frame, ...]
    path: RobotPath
    """Where the robot was, for the poses of the pictures and between them."""
    arena: Arena
    robot: RobotConfig
    """Nominal."""
    look: LookConfig
    """Nominal."""
    response: CameraResponse
    """Of the simulated pictures, or of such as would be simulated."""
    pose_errors: PoseErrors = PoseErrors()

    @property
    def camera(self) -> Camera:
        return self.robot.camera

    @property
    def heldout(self) -> Mask:
        """(frames,)."""
        return np.array([frame.heldout for frame in self.frames])

    @property
    def is_simulated(self) -> bool:
        """Whether there are simulated pictures to compare with."""
        return any(frame.simulated is not None for frame in self.frames)

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height of the pictures."""
        height, width = self.frames[0].picture.shape[:2]
        return width, height

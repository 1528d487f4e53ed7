"""Measured images with poses, and the camera and the map with which they are compared."""

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
ImagePixels = NDArray[np.uint8]

HELD_OUT_EACH = 4
"""Every fourth image is held out of the fit."""


@dataclass(frozen=True)
class PoseErrors:
    """Standard deviations of the poses that come with the images, independent from image to image."""

    position_m: float = 0.0005
    yaw_deg: float = 0.1


@dataclass(frozen=True)
class CameraFrame:
    """One measured image."""

    number: int
    t_s: float
    image: ImagePixels
    """(H, W, 3) RGB, the measured image."""
    simulated: ImagePixels | None
    """(H, W, 3) RGB, simulated with the nominal camera at the same place; None without one."""
    heldout: bool


@dataclass(frozen=True)
class CameraCase:
    name: str
    frames: tuple[CameraFrame, ...]
    path: RobotPath
    """Path of the robot, which gives the poses of the images and those between them."""
    arena: Arena
    robot: RobotConfig
    """Nominal robot."""
    look: LookConfig
    """Nominal look."""
    response: CameraResponse
    """Camera response of the simulated images, or of those that a simulation would make."""
    pose_errors: PoseErrors = PoseErrors()

    @property
    def camera(self) -> Camera:
        return self.robot.camera

    @property
    def heldout(self) -> Mask:
        """Return which frames are held out, (frames,)."""
        return np.array([frame.heldout for frame in self.frames])

    @property
    def is_simulated(self) -> bool:
        """Return whether there are simulated images to compare with."""
        return any(frame.simulated is not None for frame in self.frames)

    @property
    def size_px(self) -> tuple[int, int]:
        """Return width and height of the images."""
        height, width = self.frames[0].image.shape[:2]
        return width, height

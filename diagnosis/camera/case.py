"""Measured images with poses, and the camera and the map with which they are compared."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Self

import numpy as np
from numpy.typing import NDArray

from configs.schema.appearance.look import LookConfig
from configs.schema.robot import Camera, RobotConfig
from diagnosis.measured.channel import Mask
from sensors.camera.response import CameraResponse
from symolo.arena.geometry import Arena
from symolo.core.geometry.robot_path import RobotPath

Ints = NDArray[np.int64]
ImagePixels = NDArray[np.uint8]

HELD_OUT_EACH = 4
"""Every fourth image is held out of the fit."""


@dataclass(frozen=True)
class SampleArrays:
    """Base of classes whose fields are arrays with one row for each of N samples."""

    def __len__(self) -> int:
        return len(getattr(self, fields(self)[0].name))

    def some(self, which: Mask | Ints) -> Self:
        """Return some of the samples."""
        return type(self)(*(getattr(self, field.name)[which] for field in fields(self)))

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """Return the samples of at least one part together."""
        return cls(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(cls)))


@dataclass(frozen=True)
class PoseErrors:
    """Standard deviations of the poses that come with the images, independent from image to image."""

    position_m: float = 0.0005
    yaw_deg: float = 0.1


@dataclass(frozen=True)
class CameraFrame:
    """One measured image."""

    number: int
    """Number in the name of the file."""
    t_s: float
    """Time of the exposure, in the time of the path."""
    image: ImagePixels
    """(H, W, 3) RGB, the measured image."""
    simulated: ImagePixels | None
    """(H, W, 3) RGB, simulated with the nominal camera at the same place; None without one."""
    heldout: bool


@dataclass(frozen=True)
class CameraCase:
    """All that a camera identification compares."""

    name: str
    frames: tuple[CameraFrame, ...]
    path: RobotPath
    """Path of the robot, which gives the poses of the images and those between them."""
    arena: Arena
    robot: RobotConfig
    """Nominal robot, whose camera is identified."""
    look: LookConfig
    """Nominal look of the room."""
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
    def line_is_dark(self) -> bool:
        """Return whether the line is darker than the floor."""
        return self.arena.line.reflectance < self.arena.floor_reflectance

    @property
    def is_simulated(self) -> bool:
        """Return whether there are simulated images to compare with."""
        return any(frame.simulated is not None for frame in self.frames)

    @property
    def size_px(self) -> tuple[int, int]:
        """Return width and height of the images."""
        height, width = self.frames[0].image.shape[:2]
        return width, height

"""Poses, shapes and colours of model files, from those of the simulation and of the rendered scene."""

from dataclasses import dataclass
from math import pi

import numpy as np

from blender_scenes.scene.description import Mesh
from physics.robot.links import BoxShape, SphereShape, Vector
from sensors.camera.colour import RGB
from symolo.core.arrays import Array
from symolo.core.geometry.poses import roll_pitch_yaw


@dataclass(frozen=True)
class Placement:
    """A pose: origin [m], and roll, pitch, yaw [rad] about the fixed axes x, y, z, as URDF and SDF have it."""

    xyz: Vector = (0.0, 0.0, 0.0)
    rpy: Vector = (0.0, 0.0, 0.0)

    @classmethod
    def from_pose(cls, X: Array) -> "Placement":
        """Return the placement of a (4, 4) pose."""
        x, y, z = (X[:3, 3] + 0.0).tolist()
        return cls((x, y, z), roll_pitch_yaw(X[:3, :3]))


@dataclass(frozen=True)
class CylinderShape:
    """A cylinder about the y axis of its frame, as wheels are."""

    radius_m: float
    width_m: float


Shape = BoxShape | SphereShape | CylinderShape


@dataclass(frozen=True)
class Visual:
    """A visible shape."""

    name: str
    shape: Shape
    center: Vector
    """x, y, z [m] of its centre in the frame of its link."""
    srgb: RGB
    """Red, green and blue, 0-1 each, as it is to be shown."""

    @property
    def placement(self) -> Placement:
        """Pose in the frame of its link; cylinders of model files stand along z, and wheels lie along y."""
        lies = isinstance(self.shape, CylinderShape)
        return Placement(self.center, (0.5 * pi, 0.0, 0.0) if lies else (0.0, 0.0, 0.0))


def srgb(linear: RGB) -> RGB:
    """Return sRGB by the transfer function of IEC 61966-2-1, rounded to four digits."""
    value = np.clip(np.asarray(linear, dtype=float), 0.0, 1.0)
    shown = np.where(value <= 0.0031308, 12.92 * value, 1.055 * value ** (1 / 2.4) - 0.055)
    red, green, blue = (round(part, 4) for part in shown.tolist())
    return red, green, blue


def bounding_box(mesh: Mesh) -> tuple[Vector, Vector]:
    """Return centre and size [m] of a mesh along the axes of its frame."""
    vertices = np.array(mesh.vertices)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    x, y, z = (np.round(0.5 * (low + high), 9) + 0.0).tolist()
    length, width, height = np.round(high - low, 9).tolist()
    return (x, y, z), (length, width, height)

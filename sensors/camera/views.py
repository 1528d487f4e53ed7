"""Views: the poses of camera and scene in each image."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from sensors.camera.colour import RGB
from symolo.core.geometry.pinhole import Shutter
from symolo.core.geometry.poses import Matrix4, PlanarPose

INSTANT = Shutter()


# A default value is left out of the JSON text. A job without moving obstacles, flicker or exposure time therefore has
# the same bytes as one of a version without these fields.


def _is_empty(items: tuple[object, ...]) -> bool:
    return not items


def _is_one(gain: RGB) -> bool:
    return gain == (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Moment:
    """The poses of robot, camera and moving meshes at one time."""

    robot_pose: PlanarPose
    """Pose of R."""
    X_WC: Matrix4
    """Pose of the optical frame (x right, y down, z forward) in W."""
    moving: Annotated[tuple[PlanarPose, ...], Field(exclude_if=_is_empty)] = ()
    """Poses of the scene's moving meshes, in their order."""


@dataclass(frozen=True)
class FrameView:
    """One image to render."""

    number: int
    t_s: float
    robot_pose: PlanarPose
    """Pose of R."""
    X_WC: Matrix4
    """Pose of the optical frame (x right, y down, z forward) in W."""
    moving: Annotated[tuple[PlanarPose, ...], Field(exclude_if=_is_empty)] = ()
    """Poses of the scene's moving meshes, in their order."""
    light_gain: Annotated[RGB, Field(exclude_if=_is_one)] = (1.0, 1.0, 1.0)
    """Light of this frame divided by its mean over time; it differs from 1 if lamps flicker."""
    exposure: Annotated[tuple[Moment, ...], Field(exclude_if=_is_empty)] = ()
    """Moments at equal intervals from the opening of the shutter to its closing; empty for an instant."""

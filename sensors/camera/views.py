"""Views: the poses of camera and scene in each image."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from sensors.camera.colour import RGB
from symolo.core.pinhole import Shutter
from symolo.core.poses import Matrix4, PlanarPose

INSTANT = Shutter()


# A default is left out of the JSON text, so that a job without moving obstacles, flicker or exposure time has the
# same bytes whether or not the program that wrote it knows of these.


def _is_empty(items: tuple[object, ...]) -> bool:
    return not items


def _is_one(gain: RGB) -> bool:
    return gain == (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Moment:
    """Where everything is at one time."""

    robot_pose: PlanarPose
    """Pose of R."""
    X_WC: Matrix4
    """Pose of the optical frame (x right, y down, z forward) in W."""
    moving: Annotated[tuple[PlanarPose, ...], Field(exclude_if=_is_empty)] = ()
    """Poses of the scene's moving meshes, in their order."""


@dataclass(frozen=True)
class FrameView:
    """One image to be taken."""

    number: int
    t_s: float
    robot_pose: PlanarPose
    """Pose of R."""
    X_WC: Matrix4
    """Pose of the optical frame (x right, y down, z forward) in W."""
    moving: Annotated[tuple[PlanarPose, ...], Field(exclude_if=_is_empty)] = ()
    """Poses of the scene's moving meshes, in their order."""
    light_gain: Annotated[RGB, Field(exclude_if=_is_one)] = (1.0, 1.0, 1.0)
    """Light of this frame divided by its mean over time, which differs from 1 where lamps flicker."""
    exposure: Annotated[tuple[Moment, ...], Field(exclude_if=_is_empty)] = ()
    """Moments at equal distances from the opening of the shutter to its closing; empty for an instant."""

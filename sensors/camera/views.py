"""Views: the poses of camera and scene in each image."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from sensors.camera.colour import RGB
from symolo.core.geometry.pinhole import Shutter
from symolo.core.geometry.poses import Matrix4, PlanarPose
from symolo.core.left_out import equals

INSTANT = Shutter()


@dataclass(frozen=True)
class Moment:
    """The poses of robot, camera and moving meshes at one time."""

    robot_pose: PlanarPose
    """Pose of R."""
    X_WC: Matrix4
    """Pose of the optical frame (x right, y down, z forward) in W."""
    moving: Annotated[tuple[PlanarPose, ...], Field(exclude_if=equals(()))] = ()
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
    moving: Annotated[tuple[PlanarPose, ...], Field(exclude_if=equals(()))] = ()
    """Poses of the scene's moving meshes, in their order."""
    light_gain: Annotated[RGB, Field(exclude_if=equals((1.0, 1.0, 1.0)))] = (1.0, 1.0, 1.0)
    """Light of this frame divided by its mean over time; it differs from 1 if lamps flicker."""
    exposure: Annotated[tuple[Moment, ...], Field(exclude_if=equals(()))] = ()
    """Moments at equal intervals from the opening of the shutter to its closing; empty for an instant."""

"""A room for the rest of the scene: meshes, surfaces, and the window that lets the daylight in."""

from dataclasses import dataclass

from blender_scenes.scene.description import Mesh, Point2, Point3
from blender_scenes.scene.shading import Surface
from symolo.core.geometry.poses import PlanarPose


@dataclass(frozen=True)
class Opening:
    """A window's clear rectangle in a wall."""

    center: Point3
    right: Point3
    """Unit vector along the width, to the right for somebody who looks out."""
    up: Point3
    inward: Point3
    """Unit normal, right x up."""
    width_m: float
    height_m: float


@dataclass(frozen=True)
class Top:
    """The top of a table."""

    pose: PlanarPose
    """Pose of its middle."""
    size_m: tuple[float, float]
    height_m: float


@dataclass(frozen=True)
class Furnishing:
    """A piece of furniture in its place, for the record of the scene."""

    name: str
    """Kind and number, such as `chair_0`; also the name of its mesh."""
    pose: PlanarPose
    """Pose of its frame: x along the width, +y towards its back or the wall that it hangs on."""
    size_m: tuple[float, float]
    """Size of its footprint along x and y; the frame's origin is in the middle."""
    height_m: tuple[float, float]
    """Heights of its lowest and its highest point above the floor."""
    numbers: object
    """Dataclass of dimensions and colours from which it was made."""


@dataclass(frozen=True)
class RoomModel:
    """A furnished room around the arena, in W."""

    low: Point2
    """South-west corner of the floor [m]."""
    high: Point2
    """North-east corner of the floor [m]."""
    height_m: float
    wall_depth_m: float
    window: Opening
    """Opening through which daylight comes in."""
    meshes: tuple[Mesh, ...]
    """All meshes of the room but the floor."""
    surfaces: tuple[Surface, ...]
    """Surfaces that the meshes name."""
    tops: tuple[Top, ...] = ()
    """Tops of the tables, in the order of their numbers."""
    furniture: tuple[Furnishing, ...] = ()
    """Pieces for which there was room, in the order in which they were placed."""

"""What a room is to the rest of the scene: its meshes and surfaces, and the opening that lets the daylight in."""

from dataclasses import dataclass

from blender_scenes.scene.description import Mesh, Point2, Point3
from blender_scenes.scene.shading import Surface
from symolo.core.poses import PlanarPose


@dataclass(frozen=True)
class Opening:
    """A window's clear rectangle in a wall."""

    center: Point3
    right: Point3
    """Unit vector along the width, as seen from inside looking out."""
    up: Point3
    inward: Point3
    """Unit normal, right x up."""
    width_m: float
    height_m: float


@dataclass(frozen=True)
class Top:
    """A table's top."""

    pose: PlanarPose
    """Of its middle."""
    size_m: tuple[float, float]
    height_m: float


@dataclass(frozen=True)
class Furnishing:
    """A piece of furniture as it was drawn, in its place."""

    name: str
    """Its kind and its number among the kind's; also that of its mesh."""
    pose: PlanarPose
    """Of its frame: x along the width, the back, or the wall that it hangs on, towards +y."""
    size_m: tuple[float, float]
    """Of the ground that it takes, along x and y, its origin in the middle."""
    height_m: tuple[float, float]
    """Lowest and highest point above the floor."""
    numbers: object
    """What it was made from: a frozen dataclass of its kind."""


@dataclass(frozen=True)
class RoomModel:
    low: Point2
    """South-west corner of the floor [m]."""
    high: Point2
    height_m: float
    wall_depth_m: float
    window: Opening
    meshes: tuple[Mesh, ...]
    """Without the floor, whose material is chosen apart."""
    surfaces: tuple[Surface, ...]
    tops: tuple[Top, ...] = ()
    """Of the tables, in the order of their numbers."""
    furniture: tuple[Furnishing, ...] = ()
    """What found a place, in the order in which it did."""

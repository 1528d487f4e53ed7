"""The scene as data: meshes, surfaces, lights and sky, free of any renderer.

Units are metres and radians. Light is photometric in thousands (kilolux, kilocandela per square metre), so that a
radiance of 1 is 1000 cd/m2; exposure makes pixels of it. Everything stands in W but the robot's parts, which do in R,
and the moving obstacles, each of which does in a frame of its own, its origin on the floor below its middle.
"""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from blender_scenes.scene.shading import Surface
from sensors.camera.colour import RGB

Point3 = tuple[float, float, float]
Point2 = tuple[float, float]


# A default is left out of the JSON text, so that a job without moving meshes, a visible robot or a user's panorama has
# the same bytes whether or not the program that wrote it knows of these.


def _is_empty(items: tuple[object, ...]) -> bool:
    return not items


def _is_none(mean: RGB | None) -> bool:
    return mean is None


@dataclass(frozen=True)
class Mesh:
    name: str
    vertices: tuple[Point3, ...]
    """(N, 3) [m]."""
    faces: tuple[tuple[int, ...], ...]
    """Vertex numbers of each polygon, counter-clockwise seen from outside."""
    uv_m: tuple[tuple[Point2, ...], ...]
    """Surface coordinates of each corner of each face [m]."""
    face_surface: tuple[str, ...]
    """Name of each face's surface."""


@dataclass(frozen=True)
class Panel:
    """A rectangle that shines to one side, evenly over its area."""

    name: str
    center: Point3
    right: Point3
    """Unit vector along the width."""
    up: Point3
    """Unit vector along the height; light leaves along right x up."""
    width_m: float
    height_m: float
    radiance: RGB
    seen: bool = True
    """False where the camera sees something else in its place, also through glass; gloss has its light all the same."""
    on_mains: bool = False
    """Whether it flickers with the alternating current."""


@dataclass(frozen=True)
class Sun:
    towards: Point3
    """Unit vector from the scene to the sun."""
    irradiance: RGB
    """On a surface that faces the sun."""
    angular_diameter_rad: float


@dataclass(frozen=True)
class Sky:
    """A panorama all around: what the camera sees outside, also through glass.

    It lights nothing. A panel in each window stands for its light and its image in gloss, which so need far fewer
    samples; and a ray that is thrown for the gloss and meets the sky would bring its light for the matt part too.
    """

    panorama: str
    """One of those shipped with bpy, or the SHA-256 of a file of the user's own."""
    yaw_rad: float
    gain: float
    """Radiance per unit of the panorama."""
    ceiling: float
    """Components of the panorama are cut off here, before the gain: its sun is no part of the sky."""
    saturation: float
    """1 as it was taken, 0 grey."""
    mean: Annotated[RGB | None, Field(exclude_if=_is_none)] = None
    """Colour above the horizon of a file of the user's own; None for the shipped ones, which are known."""


@dataclass(frozen=True)
class Scene:
    surfaces: tuple[Surface, ...]
    meshes: tuple[Mesh, ...]
    """Of what stands still: the floor, each piece of the line, walls and obstacles in the arena's order, the room."""
    robot: tuple[Mesh, ...]
    """The robot's parts that its camera does not see, in R; they throw shadows and are mirrored."""
    panels: tuple[Panel, ...]
    sun: Sun | None
    sky: Sky
    moving: Annotated[tuple[Mesh, ...], Field(exclude_if=_is_empty)] = ()
    """Each in its own frame; a view says where that is."""
    robot_in_sight: Annotated[tuple[Mesh, ...], Field(exclude_if=_is_empty)] = ()
    """The robot's parts that it sees, in R."""

    @property
    def robot_parts(self) -> tuple[Mesh, ...]:
        """All of them."""
        return (*self.robot, *self.robot_in_sight)

"""The scene as data: meshes, surfaces, lights and sky, free of any renderer.

Units are metres and radians. Light is photometric in thousands (kilolux, kilocandela per square metre), so that a
radiance of 1 is 1000 cd/m2. Coordinates are those of W, but the robot's parts have those of R, and each moving obstacle
has its own frame with the origin on the floor below its middle.
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
    """A mesh of polygons, each with the name of its surface."""

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
class LightPanel:
    """A rectangle that emits light to one side, evenly over its area."""

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
    """Whether the camera sees it directly or through glass; mirror images in gloss show it in any case."""
    on_mains: bool = False
    """Whether it flickers with the alternating current."""


@dataclass(frozen=True)
class Sun:
    """Parallel light."""

    towards: Point3
    """Unit vector from the scene to the sun."""
    irradiance: RGB
    """Irradiance of a surface that faces the sun."""
    angular_diameter_rad: float


@dataclass(frozen=True)
class Sky:
    """A panorama all around: what the camera sees outside, also through glass.

    It lights nothing. A panel in the window has its light and its mirror image instead, which needs far fewer samples;
    and a gloss ray that met the sky would add its light to the matt part as well.
    """

    panorama: str
    """Name of a panorama of bpy, or the SHA-256 of a user's file."""
    yaw_rad: float
    gain: float
    """Radiance per unit of the panorama."""
    ceiling: float
    """Maximum of the panorama's components before the gain, which removes its sun."""
    saturation: float
    """Factor on the saturation of the panorama; 0 for grey."""
    mean: Annotated[RGB | None, Field(exclude_if=_is_none)] = None
    """Mean colour above the horizon of a user's file; None for a panorama of bpy."""


@dataclass(frozen=True)
class Scene:
    """Everything that an image of a run may show, and its light."""

    surfaces: tuple[Surface, ...]
    meshes: tuple[Mesh, ...]
    """Meshes that stand still: floor, pieces of the line, walls and obstacles in the arena's order, room."""
    robot: tuple[Mesh, ...]
    """The robot's parts that its camera does not see, in R; they have shadows and mirror images."""
    panels: tuple[LightPanel, ...]
    sun: Sun | None
    sky: Sky
    moving: Annotated[tuple[Mesh, ...], Field(exclude_if=_is_empty)] = ()
    """Moving obstacles, each in its own frame; a view has the poses of these frames."""
    robot_in_sight: Annotated[tuple[Mesh, ...], Field(exclude_if=_is_empty)] = ()
    """The robot's parts that its camera sees, in R."""

    @property
    def robot_parts(self) -> tuple[Mesh, ...]:
        """All parts of the robot."""
        return (*self.robot, *self.robot_in_sight)

"""The arena: floor, line, walls and obstacles, all in the world frame W (x, y on the floor, z up)."""

from functools import lru_cache
from typing import Annotated, Any, Literal

from pydantic import Field, ModelWrapValidatorHandler, model_validator
from typing_extensions import Self

from configs.schema.appearance.surface import SurfaceName
from configs.schema.arena_generator import ArenaGenerator
from configs.schema.base import FromList, Point2, Section, Size3, Slug, absent, disagreement
from configs.schema.mesh import MeshFile
from configs.schema.obstacle_shapes import ObstacleShape


class _Piece(Section):
    joined: bool = Field(default_factory=lambda: False, exclude_if=lambda joined: not joined)  # not written into files
    """Whether tape and paint continue from the piece before without a joint."""


class StraightPiece(_Piece):
    """A straight piece of the line."""

    kind: Literal["straight"]
    """Kind of the piece: a straight from `start` to `end`."""
    start: Point2
    """First point: x, y [m] in W."""
    end: Point2
    """Last point: x, y [m] in W."""


class ArcPiece(_Piece):
    """A piece of the line that is an arc."""

    kind: Literal["arc"]
    """Kind of the piece: an arc about `center`."""
    center: Point2
    """Centre of the arc: x, y [m] in W."""
    radius_m: float = Field(gt=0.02, le=5.0)
    """Radius of the arc [m]."""
    start_deg: float = Field(ge=-720, le=720)
    """Direction from the centre to the first point, counter-clockwise from +x."""
    end_deg: float = Field(ge=-720, le=720)
    """Direction from the centre to the last point; larger than `start_deg` for an arc to the left."""


LinePiece = Annotated[StraightPiece | ArcPiece, Field(discriminator="kind")]


class LineCourse(Section):
    """A line through points, in the place of `pieces`."""

    points: Annotated[tuple[Point2, ...], FromList, Field(min_length=2, max_length=500)]
    """Points in driving order: x, y [m] in W; no distributions."""
    shape: Literal["rounded", "spline"] = "rounded"
    """Straights from point to point with rounded corners, or a smooth curve through all points."""
    closed: bool = True
    """Whether the line returns from the last point to the first one."""
    bend_radius_m: float = Field(default=0.15, ge=0.02, le=5.0)
    """Radius of the arcs at the corners of a `rounded` line [m]."""


class LineConfig(Section):
    """The line on the floor; its course is a sequence of straights and arcs."""

    width_m: float = Field(default=0.015, ge=0.004, le=0.1)
    """Width of the line [m]."""
    reflectance: float = Field(default=0.05, ge=0, le=1)
    """Reflectance at the line sensor's infrared wavelength; 0 black, 1 white."""
    pieces: Annotated[tuple[LinePiece, ...], FromList] = ()
    """Straights and arcs, in driving order; without any, the floor has no line."""
    course: LineCourse | None = Field(default_factory=absent, exclude=True)
    """Points of the line, in the place of `pieces`; the specification of a run has the pieces."""


class Floor(Section):
    """The floor of the arena, a square."""

    half_extent_m: float = Field(default=4.0, ge=0.5, le=50)
    """Half the side of the square floor around the origin of W [m]."""
    reflectance: float = Field(default=0.85, ge=0, le=1)
    """Reflectance at the line sensor's infrared wavelength; 0 black, 1 white."""


class WallConfig(Section):
    """A straight wall, defined by the face that the robot sees. Looking from `start` to `end`, the robot is on the left
    of the face, and the body of the wall is on its right.
    """

    name: Slug
    """Name of the wall, unique in the arena."""
    start: Point2
    """First point of the face at the floor: x, y [m] in W."""
    end: Point2
    """Last point of the face at the floor: x, y [m] in W."""
    height_m: float = Field(default=0.15, ge=0.01, le=3)
    """Height of the wall [m]."""
    thickness_m: float = Field(default=0.02, ge=0.001, le=0.5)
    """Thickness of the wall behind the face [m]."""
    surface: SurfaceName = "white_board"
    """Surface of the wall, which range sensors and images show."""


class WallPolygon(Section):
    """Walls along a polygon: a room around the robot, a pillar beside it, or an open row of walls."""

    name: Slug
    """Name of the polygon; its walls are NAME_1, NAME_2 and so on, from the first point."""
    points: Annotated[tuple[Point2, ...], FromList, Field(min_length=2, max_length=500)]
    """Corners of the faces that the robot sees, in one direction around the polygon: x, y [m] in W."""
    robot_is: Literal["inside", "outside", "left"] = "inside"
    """Side on which the robot is: inside or outside of a closed polygon, or to the left of an open row of walls."""
    height_m: float = Field(default=0.15, ge=0.01, le=3)
    """Height of the walls [m]."""
    thickness_m: float = Field(default=0.02, ge=0.001, le=0.5)
    """Thickness of the walls behind their faces [m]."""
    surface: SurfaceName = "white_board"
    """Surface of the walls, which range sensors and images show."""


class Waypoint(Section):
    """Place of an obstacle at one time, relative to its place at t = 0, so that a drawn place moves the whole path."""

    t_s: float = Field(gt=0, le=36_000)
    """Time since the start of the run, larger than 0, because the obstacle begins at its `center`."""
    offset: Point2 = (0.0, 0.0)
    """Displacement since t = 0: x, y [m] in W."""
    turn_deg: float = Field(default=0.0, ge=-36_000, le=36_000)
    """Turn since t = 0, counter-clockwise; 360 is a whole turn."""


class MotionConfig(Section):
    """A timed path, at constant speed from each waypoint to the next; the first leg begins at t = 0 with offset 0."""

    waypoints: Annotated[tuple[Waypoint, ...], FromList, Field(min_length=1)]
    """Places in the order of their times."""
    repeat: Literal["once", "loop", "back_and_forth"] = "once"
    """After the last waypoint: stay there, start again (a closed path), or go back and forth along the path."""


class Obstacle(Section):
    """A box or another body on the floor, which may move."""

    name: Slug
    """Name of the obstacle, unique in the arena; a moving one has columns of this name."""
    center: Point2
    """Middle of the box's footprint: x, y [m] in W."""
    size: Size3 = (0.08, 0.08, 0.12)
    """Length, width and height of the box [m], before the rotation; those of a mesh or shape follow from it."""
    mesh: MeshFile | None = Field(default_factory=absent, exclude_if=lambda mesh: mesh is None)
    """Shape from a file, in place of a box."""
    shape: ObstacleShape | None = Field(default_factory=absent, exclude=True)
    """Another shape, in place of a box; the specification of a run has its triangles as a mesh."""
    solid: bool = Field(default_factory=lambda: True, exclude_if=lambda solid: solid)  # not written into files
    """Whether the robot touches it and range sensors see it; without, it is furniture that only images show."""
    yaw_deg: float = Field(default=0.0, ge=-360, le=360)
    """Rotation of the box, counter-clockwise."""
    surface: SurfaceName = "cardboard"
    """Surface of the box, which range sensors and images show."""
    motion: MotionConfig | None = Field(default_factory=absent, exclude_if=lambda motion: motion is None)
    """Path of the obstacle, from `center` and `yaw_deg` at t = 0; without it the obstacle does not move."""

    @model_validator(mode="wrap")
    @classmethod
    def _with_triangles(cls, content: Any, validate: ModelWrapValidatorHandler[Self]) -> Self:  # noqa: ANN401 - anything
        """Replace a shape by its triangles, so that no other code has to know it."""
        obstacle = validate(content)
        shape = obstacle.shape
        if shape is None:
            return obstacle
        if obstacle.mesh is not None:
            raise disagreement("shape", shape.kind, "none beside mesh", "leave out shape or mesh")
        mesh, size = _body(shape)  # pyright: ignore[reportArgumentType] - frozen models have a hash
        return obstacle.model_copy(update={"shape": None, "mesh": mesh, "size": size})


@lru_cache(maxsize=256)
def _body(shape: ObstacleShape) -> tuple[MeshFile, tuple[float, float, float]]:
    """Return the triangles of a shape as a specification has them, and its size; a scenario asks for each often."""
    body = shape.triangles()
    return MeshFile(file=shape.kind, packed=body.packed()), body.size


class ArenaConfig(Section):
    """Floor, line, walls and obstacles."""

    name: Slug
    """Name of the arena."""
    description: str = ""
    """Description for people."""
    floor: Floor = Floor()
    line: LineConfig = LineConfig()
    walls: Annotated[tuple[WallConfig, ...], FromList] = ()
    obstacles: Annotated[tuple[Obstacle, ...], FromList] = ()
    polygons: Annotated[tuple[WallPolygon, ...], FromList] = Field(default_factory=tuple, exclude=True)
    """Polygons of walls; the specification of a run has them among its walls."""
    generate: ArenaGenerator | None = Field(default_factory=absent, exclude=True)
    """Recipe from which line, walls and obstacles are drawn for each run; the specification of a run has the drawn ones
    instead."""

"""The arena: floor, line, walls and obstacles, all in the world frame W (x, y on the floor, z up)."""

from typing import Annotated, Literal

from pydantic import Field

from configs.schema.arena_generator import ArenaGenerator
from configs.schema.base import FromList, Point2, Section, Size3, Slug, absent
from configs.schema.surface import SurfaceName


class StraightPiece(Section):
    kind: Literal["straight"]
    start: Point2
    end: Point2


class ArcPiece(Section):
    kind: Literal["arc"]
    center: Point2
    radius_m: float = Field(gt=0.02, le=5.0)
    start_deg: float = Field(ge=-720, le=720)
    """Direction from the centre to the first point, counter-clockwise from +x."""
    end_deg: float = Field(ge=-720, le=720)


LinePiece = Annotated[StraightPiece | ArcPiece, Field(discriminator="kind")]


class LineConfig(Section):
    width_m: float = Field(default=0.015, ge=0.004, le=0.1)
    reflectance: float = Field(default=0.05, ge=0, le=1)
    """Reflectance at the line sensor's infrared wavelength; 0 black, 1 white."""
    pieces: Annotated[tuple[LinePiece, ...], FromList] = ()


class Floor(Section):
    half_extent_m: float = Field(default=4.0, ge=0.5, le=50)
    reflectance: float = Field(default=0.85, ge=0, le=1)


class WallConfig(Section):
    """A straight wall, defined by the face that the robot sees; its body is on the right, seen from start to end."""

    name: Slug
    start: Point2
    end: Point2
    height_m: float = Field(default=0.15, ge=0.01, le=3)
    thickness_m: float = Field(default=0.02, ge=0.001, le=0.5)
    surface: SurfaceName = "white_board"


class Waypoint(Section):
    """Place of an obstacle at one time, relative to its place at t = 0, so that a drawn place moves the whole path."""

    t_s: float = Field(gt=0, le=36_000)
    """Time since the start of the run."""
    offset: Point2 = (0.0, 0.0)
    turn_deg: float = Field(default=0.0, ge=-36_000, le=36_000)
    """Turn since t = 0, counter-clockwise; 360 is a whole turn."""


class MotionConfig(Section):
    """A timed path, at constant speed from each waypoint to the next; the first leg begins at t = 0 with offset 0."""

    waypoints: Annotated[tuple[Waypoint, ...], FromList, Field(min_length=1)]
    repeat: Literal["once", "loop", "back_and_forth"] = "once"
    """After the last waypoint: stay there, start again (a closed path), or go back and forth along the path."""


class Obstacle(Section):
    name: Slug
    center: Point2
    size: Size3 = (0.08, 0.08, 0.12)
    yaw_deg: float = Field(default=0.0, ge=-360, le=360)
    surface: SurfaceName = "cardboard"
    motion: MotionConfig | None = Field(default_factory=absent, exclude_if=lambda motion: motion is None)
    """Path of the obstacle, from `center` and `yaw_deg` at t = 0; without it the obstacle does not move."""


class ArenaConfig(Section):
    name: Slug
    description: str = ""
    floor: Floor = Floor()
    line: LineConfig
    walls: Annotated[tuple[WallConfig, ...], FromList] = ()
    obstacles: Annotated[tuple[Obstacle, ...], FromList] = ()
    generate: ArenaGenerator | None = Field(default_factory=absent, exclude=True)
    """Recipe from which line, walls and obstacles are drawn for each run; the specification of a run has the drawn ones
    instead."""

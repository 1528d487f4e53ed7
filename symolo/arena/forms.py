"""Attributes that the geometry needs of an arena, which may be a configuration or a document.

`symolo.dataset.documents.run_document` explains the attributes.
"""

from collections.abc import Sequence
from typing import Literal, Protocol

Point2 = tuple[float, float]


class StraightForm(Protocol):
    """A straight piece of a line."""

    kind: Literal["straight"]
    start: Point2
    end: Point2
    joined: bool


class ArcForm(Protocol):
    """A piece of a line that is an arc."""

    kind: Literal["arc"]
    center: Point2
    radius_m: float
    start_deg: float
    end_deg: float
    joined: bool


class LineForm(Protocol):
    """The line on the floor, piece by piece."""

    width_m: float
    reflectance: float

    @property
    def pieces(self) -> Sequence[StraightForm | ArcForm]: ...


class FloorForm(Protocol):
    """A square floor around the origin of W."""

    half_extent_m: float
    reflectance: float


class WallForm(Protocol):
    """An upright wall between two points of the floor."""

    name: str
    start: Point2
    end: Point2
    height_m: float
    thickness_m: float

    @property
    def surface(self) -> str: ...


class WaypointForm(Protocol):
    """A place of a moving obstacle at one time."""

    t_s: float
    offset: Point2
    turn_deg: float


class MotionForm(Protocol):
    """The path of a moving obstacle."""

    repeat: Literal["once", "loop", "back_and_forth"]

    @property
    def waypoints(self) -> Sequence[WaypointForm]: ...


class MeshForm(Protocol):
    """The triangles of an obstacle that is no box."""

    packed: str


class ObstacleForm(Protocol):
    """A box or another body on the floor."""

    name: str
    center: Point2
    size: tuple[float, float, float]
    yaw_deg: float
    solid: bool

    @property
    def mesh(self) -> MeshForm | None: ...

    @property
    def surface(self) -> str: ...
    @property
    def motion(self) -> MotionForm | None: ...


class ArenaForm(Protocol):
    """Floor, line, walls and obstacles."""

    name: str

    @property
    def floor(self) -> FloorForm: ...
    @property
    def line(self) -> LineForm: ...
    @property
    def walls(self) -> Sequence[WallForm]: ...
    @property
    def obstacles(self) -> Sequence[ObstacleForm]: ...

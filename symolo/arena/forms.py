"""Attributes that the geometry needs of an arena, which may be a configuration or a document."""

from collections.abc import Sequence
from typing import Literal, Protocol

Point2 = tuple[float, float]


class StraightForm(Protocol):
    kind: Literal["straight"]
    start: Point2
    end: Point2
    joined: bool


class ArcForm(Protocol):
    kind: Literal["arc"]
    center: Point2
    radius_m: float
    start_deg: float
    end_deg: float
    joined: bool


class LineForm(Protocol):
    width_m: float
    reflectance: float

    @property
    def pieces(self) -> Sequence[StraightForm | ArcForm]: ...


class FloorForm(Protocol):
    half_extent_m: float
    reflectance: float


class WallForm(Protocol):
    name: str
    start: Point2
    end: Point2
    height_m: float
    thickness_m: float

    @property
    def surface(self) -> str: ...


class WaypointForm(Protocol):
    t_s: float
    offset: Point2
    turn_deg: float


class MotionForm(Protocol):
    repeat: Literal["once", "loop", "back_and_forth"]

    @property
    def waypoints(self) -> Sequence[WaypointForm]: ...


class MeshForm(Protocol):
    packed: str


class ObstacleForm(Protocol):
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
    name: str

    @property
    def floor(self) -> FloorForm: ...
    @property
    def line(self) -> LineForm: ...
    @property
    def walls(self) -> Sequence[WallForm]: ...
    @property
    def obstacles(self) -> Sequence[ObstacleForm]: ...

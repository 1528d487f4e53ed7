"""Places for furniture: within the room, away from the arena, and free of other pieces."""

import math
from dataclasses import dataclass, field

import numpy as np

from blender_scenes.rooms.base import Furnishing, Top
from blender_scenes.rooms.furniture import FurnitureKind
from blender_scenes.rooms.furniture.base import Piece
from blender_scenes.rooms.walls import RoomWall, WallSide
from blender_scenes.scene.description import Point2
from symolo.arena.footprints import Rectangle, overlap
from symolo.core.geometry.poses import PlanarPose

_TRIES = 80
_APART_M = 0.02
_NEAR_M = 0.5
"""Distance from the arena's clearance within which a piece counts as near the arena."""
_SKIRTING_M = 0.015
"""Thickness of the skirting board at the foot of a wall."""


@dataclass(frozen=True)
class PlacedPiece:
    """A piece of furniture and where it stands or hangs."""

    piece: Piece
    pose: PlanarPose

    @property
    def footprint(self) -> Rectangle:
        return Rectangle(self.pose[:2], self.piece.size_m, self.pose[2])

    @property
    def top(self) -> Top | None:
        """The top on which things may stand, if it has one."""
        height = self.piece.top_m
        return None if height is None else Top(self.pose, self.piece.size_m, height)

    @property
    def furnishing(self) -> Furnishing:
        piece = self.piece
        return Furnishing(piece.mesh.name, self.pose, piece.size_m, piece.height_m, piece.numbers)


@dataclass
class Ground:
    """The floor of a room and the pieces on it."""

    low: Point2
    high: Point2
    walls: tuple[RoomWall, ...]
    arena: Rectangle
    """Bounds of the arena with the clearance around them."""
    taken: list[Rectangle] = field(default_factory=list)
    tables: list[PlacedPiece] = field(default_factory=list)

    def is_free(self, ground: Rectangle) -> bool:
        (x0, y0), (x1, y1), edge = self.low, self.high, _SKIRTING_M
        if any(not (x0 + edge <= x <= x1 - edge and y0 + edge <= y <= y1 - edge) for x, y in ground.corners()):
            return False
        return not any(overlap(ground, other) for other in (self.arena, *self.taken))


def find_place(piece: Piece, kind: FurnitureKind, ground: Ground, rng: np.random.Generator) -> PlacedPiece | None:
    """Draw places until one is free, with 1 cm around the piece; None if none of `_TRIES` places is free."""
    for _ in range(_TRIES):
        standing = PlacedPiece(piece, _proposed(piece, kind, ground, rng))
        footprint = standing.footprint
        width, depth = footprint.size
        grown = Rectangle(footprint.center, (width + _APART_M, depth + _APART_M), footprint.yaw_rad)
        if ground.is_free(grown):
            ground.taken.append(footprint)
            return standing
    return None


def _proposed(piece: Piece, kind: FurnitureKind, ground: Ground, rng: np.random.Generator) -> PlanarPose:
    draw = rng.uniform()
    if draw < kind.at_a_wall:
        return _at_a_wall(piece, ground.walls[int(rng.integers(len(ground.walls)))], rng)
    if draw < kind.at_a_wall + kind.at_a_table and ground.tables:
        return _at_a_table(piece, ground.tables[int(rng.integers(len(ground.tables)))], rng)
    low, high = ground.low, ground.high
    if draw > 1.0 - kind.near_the_arena:
        half = 0.5 * np.array(ground.arena.size) + _NEAR_M
        low, high = np.subtract(ground.arena.center, half), np.add(ground.arena.center, half)
    x, y = rng.uniform(low, high).tolist()
    return x, y, float(rng.uniform(-np.pi, np.pi))


def _at_a_wall(piece: Piece, wall: RoomWall, rng: np.random.Generator) -> PlanarPose:
    width, depth = piece.size_m
    reach = 0.5 * max(0.0, wall.length_m - width)
    before = _SKIRTING_M + _APART_M + 0.5 * depth + float(rng.uniform(0.0, 0.04))
    return wall.pose(float(rng.uniform(-reach, reach)), before)


def _at_a_table(piece: Piece, table: PlacedPiece, rng: np.random.Generator) -> PlanarPose:
    """Draw a pose before one of the table's long sides, with the back away from the table, slightly turned."""
    (x, y, yaw), (length, depth) = table.pose, table.piece.size_m
    turn = float(rng.normal(0.0, 0.35))
    reach = 0.5 * (depth + math.hypot(*piece.size_m)) + float(rng.uniform(0.0, 0.3))
    along, side = float(rng.uniform(-0.5, 0.5)) * length, float(rng.choice([-1.0, 1.0]))
    c, s = math.cos(yaw), math.sin(yaw)
    facing = yaw + (0.0 if side > 0 else math.pi) + turn
    return x + c * along - s * side * reach, y + s * along + c * side * reach, facing


@dataclass
class WallFace:
    """A wall and the rectangles of it that are taken, in coordinates of its plane."""

    wall: RoomWall
    height_m: float
    taken: list[Rectangle] = field(default_factory=list)

    def is_free(self, face: Rectangle) -> bool:
        (x0, z0), _, (x1, z1), _ = face.corners()
        within = abs(x0) <= 0.5 * self.wall.length_m >= abs(x1) and z0 >= 0 and z1 <= self.height_m
        return within and not any(overlap(face, other) for other in self.taken)


def hang(piece: Piece, faces: dict[WallSide, WallFace], rng: np.random.Generator) -> PlacedPiece | None:
    """Draw places along the walls until one is free; the height of the piece does not change. None if none is free."""
    for _ in range(_TRIES):
        face = list(faces.values())[int(rng.integers(len(faces)))]
        reach = 0.5 * max(0.0, face.wall.length_m - piece.size_m[0])
        standing = hang_at(piece, face, float(rng.uniform(-reach, reach)))
        if standing is not None:
            return standing
    return None


def hang_at(piece: Piece, face: WallFace, along_m: float) -> PlacedPiece | None:
    """Hang the piece at a place of a wall; None where that is taken."""
    low, high = piece.height_m
    outline = Rectangle((along_m, 0.5 * (low + high)), (piece.size_m[0], high - low), 0.0)
    if not face.is_free(outline):
        return None
    face.taken.append(outline)
    return PlacedPiece(piece, face.wall.pose(along_m, 0.0))

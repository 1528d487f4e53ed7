"""The furniture of a room; each piece draws its numbers from a random stream that depends on its kind and number."""

from collections.abc import Iterator
from functools import partial

from blender_scenes.rooms.base import Opening
from blender_scenes.rooms.furniture import STANDING
from blender_scenes.rooms.furniture.door import drawn_door
from blender_scenes.rooms.furniture.poster import drawn_poster
from blender_scenes.rooms.furniture.radiator import MIN_SILL_M, drawn_radiator
from blender_scenes.rooms.furniture.wall_socket import drawn_wall_socket
from blender_scenes.rooms.placement import Ground, PlacedPiece, WallFace, find_place, hang, hang_at
from blender_scenes.rooms.walls import SIDES, RoomWall, WallSide, wall
from blender_scenes.scene.description import Point2
from configs.schema.appearance.look import LookConfig
from symolo.arena.footprints import Rectangle
from symolo.core.random_streams import stream

_DOORWAY_M = 0.7
"""Depth of the floor before a door that stays free."""


def furnished(  # noqa: PLR0917 - the room and what the draws depend on
    look: LookConfig, low: Point2, high: Point2, window: Opening, arena: Rectangle, seed: int
) -> list[PlacedPiece]:
    """Return all pieces that the look names and for which there is room.

    Args:
        look: Its `room.furniture` counts the pieces.
        low: South-west corner of the floor.
        high: North-east corner of the floor.
        window: Window, which stays free.
        arena: Bounds of the arena; the look's clearance around them stays free.
        seed: Seed of the run.
    """
    config = look.room.furniture
    clear = 2 * config.clearance_m
    walls: dict[WallSide, RoomWall] = {side: wall(side, low, high) for side in SIDES}
    faces: dict[WallSide, WallFace] = {side: WallFace(walls[side], look.room.height_m) for side in SIDES}
    kept_free = Rectangle(arena.center, (arena.size[0] + clear, arena.size[1] + clear), 0.0)
    ground = Ground(low, high, tuple(walls.values()), kept_free)
    opening = Rectangle((0.0, window.center[2]), (window.width_m, window.height_m), 0.0)
    faces[look.window.side].taken.append(opening)
    return [*_fixtures(look, faces, ground, window, seed), *_movables(look, ground, seed)]


def _fixtures(
    look: LookConfig, faces: dict[WallSide, WallFace], ground: Ground, window: Opening, seed: int
) -> Iterator[PlacedPiece]:
    """Yield what hangs on the walls: radiator, door, sockets and posters. The floor before the first two is taken."""
    config = look.room.furniture
    sill = window.center[2] - 0.5 * window.height_m
    placed: list[tuple[PlacedPiece | None, float]] = []
    if config.radiator and sill >= MIN_SILL_M:
        draw = partial(drawn_radiator, window_m=window.width_m, sill_m=sill)
        piece = draw("radiator", stream(seed, "room", "radiator"))
        placed.append((hang_at(piece, faces[look.window.side], 0.0), piece.size_m[1]))
    if config.door:
        rng = stream(seed, "room", "door")
        other_walls: dict[WallSide, WallFace] = {side: face for side, face in faces.items() if side != look.window.side}
        placed.append((hang(drawn_door("door", rng), other_walls, rng), 2 * _DOORWAY_M))
    for standing, depth in placed:
        if standing is not None:
            ground.taken.append(Rectangle(standing.pose[:2], (standing.piece.size_m[0], depth), standing.pose[2]))
            yield standing
    for name, count, draw in (("socket", config.sockets, drawn_wall_socket), ("poster", config.posters, drawn_poster)):
        for number in range(count):
            rng = stream(seed, "room", name, number)
            standing = hang(draw(f"{name}_{number}", rng), faces, rng)
            if standing is not None:
                yield standing


def _movables(look: LookConfig, ground: Ground, seed: int) -> Iterator[PlacedPiece]:
    for field, kind in STANDING.items():
        for number in range(getattr(look.room.furniture, field)):
            rng = stream(seed, "room", kind.name, number)
            standing = find_place(kind.draw(f"{kind.name}_{number}", rng), kind, ground, rng)
            if standing is not None:
                if field == "tables":
                    ground.tables.append(standing)
                yield standing

"""Impossible geometry of an arena: its line, walls and obstacles."""

import math
from collections.abc import Iterator

from configs.checks.motions import motion_faults
from configs.schema.arena import ArcPiece, ArenaConfig, StraightPiece
from configs.validation.faults import ConfigFault
from symolo.arena.footprints import Point
from symolo.core.yaml.tree import FieldPath, dotted

FAR = 3.0
"""Distance from the origin, in half sides of the floor, from which a point is probably given in another unit."""


def arena_faults(arena: ArenaConfig) -> Iterator[ConfigFault]:
    """Yield the faults of an arena that do not depend on the robot."""
    line: FieldPath = ("arena", "line", "pieces")
    for index, piece in enumerate(arena.line.pieces):
        yield from _piece_faults(piece, arena.line.width_m, (*line, index))
    names: dict[str, FieldPath] = {}
    for kind, items in (("walls", arena.walls), ("obstacles", arena.obstacles)):
        for index, item in enumerate(items):
            path: FieldPath = ("arena", kind, index)
            first = names.setdefault(item.name, path)
            if first != path:
                cure = "contacts and drawn values refer to names; give each another name"
                yield ConfigFault((*path, "name"), f"the same name as {dotted(first)}", got=item.name, cure=cure)
    for index, wall in enumerate(arena.walls):
        if math.dist(wall.start, wall.end) < 1e-3:
            yield ConfigFault(
                ("arena", "walls", index),
                "a wall of no length",
                got=wall.end,
                allowed="an end that differs from the start",
            )
    yield from _outside_faults(arena)
    yield from motion_faults(arena)
    yield from _generator_faults(arena)


def _generator_faults(arena: ArenaConfig) -> Iterator[ConfigFault]:
    placed: tuple[tuple[FieldPath, int], ...] = (
        (("arena", "line", "pieces"), len(arena.line.pieces)),
        (("arena", "walls"), len(arena.walls)),
        (("arena", "obstacles"), len(arena.obstacles)),
    )
    for path, count in placed:
        if arena.generate is not None and count:
            cure = f"write {dotted(path)}: [], or generate: null"
            problem = f"{count} of them beside arena.generate, which draws them"
            yield ConfigFault(path, problem, allowed="an empty list", against=("arena", "generate"), cure=cure)


def _piece_faults(piece: StraightPiece | ArcPiece, width_m: float, path: FieldPath) -> Iterator[ConfigFault]:
    if isinstance(piece, StraightPiece):
        if math.dist(piece.start, piece.end) < 1e-3:
            yield ConfigFault(
                path, "a straight piece of no length", got=piece.end, allowed="an end that differs from the start"
            )
        return
    sweep_deg = abs(piece.end_deg - piece.start_deg)
    if sweep_deg < 0.1:
        yield ConfigFault(path, "an arc of no length", got=piece.end_deg, allowed="end_deg other than start_deg")
    if sweep_deg > 360:
        yield ConfigFault(
            path, "the arc overlaps itself", got=sweep_deg, allowed="at most 360 from start_deg to end_deg"
        )
    if piece.radius_m <= width_m / 2:
        allowed = f"more than half the line's width of {width_m}"
        yield ConfigFault((*path, "radius_m"), got=piece.radius_m, allowed=allowed)


def _outside_faults(arena: ArenaConfig) -> Iterator[ConfigFault]:
    limit = arena.floor.half_extent_m
    points: list[tuple[FieldPath, Point]] = []
    for index, piece in enumerate(arena.line.pieces):
        path: FieldPath = ("arena", "line", "pieces", index)
        if isinstance(piece, StraightPiece):
            points += [((*path, "start"), piece.start), ((*path, "end"), piece.end)]
        else:
            points += [(path, point) for point in _outermost(piece)]
    for index, wall in enumerate(arena.walls):
        points += [(("arena", "walls", index, "start"), wall.start), (("arena", "walls", index, "end"), wall.end)]
    points += [(("arena", "obstacles", i, "center"), obstacle.center) for i, obstacle in enumerate(arena.obstacles)]
    for path, point in points:
        if (farthest := max(abs(point[0]), abs(point[1]))) > limit:
            allowed = f"points on the floor, within {limit} m of the origin along x and y"
            cure = "move it or enlarge arena.floor.half_extent_m"
            if farthest >= FAR * limit:
                cure = f"are the lengths of the arena in metres? If they are, {cure}"
            yield ConfigFault(path, "beyond the edge of the floor", got=point, allowed=allowed, cure=cure)


def _outermost(arc: ArcPiece) -> list[Point]:
    """Return points of an arc that include its extremes along x and y: the ends, and where it runs along an axis."""
    low, high = sorted((arc.start_deg, arc.end_deg))
    quarters = range(math.ceil(low / 90), math.floor(high / 90) + 1)
    directions = [math.radians(deg) for deg in (low, high, *(90 * quarter for quarter in quarters))]
    (x, y), r = arc.center, arc.radius_m
    return [(x + r * math.cos(direction), y + r * math.sin(direction)) for direction in directions]

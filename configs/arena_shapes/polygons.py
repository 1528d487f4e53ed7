"""Polygons of walls, which become single walls before anything is drawn."""

from itertools import pairwise
from typing import Annotated

import numpy as np

from configs.arena_shapes.short_forms import checked_alone
from configs.schema.arena import WallPolygon
from configs.schema.base import FromList, Section
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.yaml.tree import Node, node_of

Point = tuple[float, float]


class _Arena(Section):
    polygons: Annotated[tuple[WallPolygon, ...], FromList]


class _Alone(Section):
    """A tree with polygons alone, so that messages have their paths."""

    arena: _Arena


def with_polygons(root: Node) -> Node:
    """Return the tree with the walls of all polygons in place of the polygons.

    Args:
        root: Tree of a scenario, or of a section, with all defaults.

    Raises:
        InputError: A polygon is wrong, or has a random corner, which two walls share.
    """
    arena = root.child("arena")
    polygons = arena.child("polygons") if arena else None
    if arena is None or polygons is None or not isinstance(arena.value, dict) or not isinstance(root.value, dict):
        return root
    fields = {key: node for key, node in arena.value.items() if key != "polygons"}
    if polygons.value is not None:
        cure = "write numbers; the walls of a polygon share their corners"
        alone = checked_alone(root, ("arena", "polygons"), _Alone, cure)
        for index, polygon in enumerate(alone.arena.polygons):
            _check_crossing(polygon, f"arena.polygons.{index}.points", root.place_of(("arena", "polygons", index)))
        walls = fields.get("walls", Node((), arena.where))
        boxes = walls.value if isinstance(walls.value, tuple) else ()
        built = [wall for polygon in alone.arena.polygons for wall in walls_of(polygon)]
        nodes = tuple(node_of(wall, polygons.where) for wall in built)
        fields["walls"] = Node((*boxes, *nodes), walls.where)
    return Node({**root.value, "arena": Node(fields, arena.where)}, root.where)


def _check_crossing(polygon: WallPolygon, field: str, where: str) -> None:
    """Refuse a polygon two of whose sides cross; sides that only touch are allowed."""
    begins = np.array(polygon.points)
    ends = np.roll(begins, -1, axis=0)
    if polygon.robot_is == "left":
        begins, ends = begins[:-1], ends[:-1]
    # The ends of one side are on different sides of the other one, and the other way round.
    begin_left, end_left = _left_of(begins, ends, begins), _left_of(begins, ends, ends)
    parts = begin_left * end_left < 0.0
    crossing = np.argwhere(np.triu(parts & parts.T))
    if len(crossing):
        one, other = 1 + crossing[0]
        cure = "list the corners in their order around the polygon"
        raise InputError(f"{field}: the sides {one} and {other} cross", where=where, cure=cure)


def _left_of(begins: Array, ends: Array, points: Array) -> Array:
    """Return (N, M), above 0 where point M is to the left of the line from begin to end N; 0 on this line."""
    along, to = (ends - begins)[:, None], points[None] - begins[:, None]
    return along[..., 0] * to[..., 1] - along[..., 1] * to[..., 0]


def walls_of(polygon: WallPolygon) -> list[dict[str, object]]:
    """Return the walls of a polygon as an arena file has them; the body of each is on the right of start to end."""
    points = list(polygon.points)
    if polygon.robot_is != "left":
        # Around a robot that is inside, counter-clockwise walls have it on their left.
        if (_area2(points) > 0.0) != (polygon.robot_is == "inside"):
            points = [points[0], *points[:0:-1]]
        points.append(points[0])
    common = polygon.model_dump(include={"height_m", "thickness_m", "surface"})
    sides = enumerate(pairwise(points), start=1)
    return [{"name": f"{polygon.name}_{n}", "start": [*a], "end": [*b], **common} for n, (a, b) in sides]


def _area2(points: list[Point]) -> float:
    """Return twice the area [m2] of a polygon, above 0 for counter-clockwise corners."""
    ends = [*points[1:], points[0]]
    return sum(ax * by - bx * ay for (ax, ay), (bx, by) in zip(points, ends, strict=True))

"""Places of the names of walls and obstacles on a map: beside their box, and on no other name if there is room."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from symolo.arena.footprints import Point, Rectangle, overlap
from symolo.arena.geometry import Box
from symolo.core.arrays import Array

GAP_PT = 8.0
"""Distance of the middle of a name from the side of its box; of a name beside it, of the near end."""
FONT_PT = 7.0
_CHARACTER = 0.62
"""Mean width of a character, as a share of the size of the font."""
_SHORT_NAME = 3
"""Number of characters of a name that stands beside its box as well as above it."""
_ON_A_NAME, _OUTSIDE, _ON_A_BOX, _FAR = 100.0, 50.0, 10.0, 5.0
"""Costs of a place where a name covers another name, leaves the map, covers a box, or is away from the middle of its
side. Among places of the same cost, that which faces away from the middle of the map is better."""


@dataclass(frozen=True)
class Label:
    """Where the name of a box stands."""

    name: str
    anchor_m: Point
    """Point on the side of the box."""
    offset_pt: Point
    """From there to the middle of the text [point]."""
    turn_deg: float

    def rectangle(self, points_per_m: float) -> Rectangle:
        """Return the area of the text [point]."""
        center = tuple(points_per_m * at + offset for at, offset in zip(self.anchor_m, self.offset_pt, strict=True))
        return Rectangle((center[0], center[1]), _text_size(self.name), math.radians(self.turn_deg))


def placed_labels(boxes: Sequence[Box], low: Array, high: Array, points_per_m: float) -> list[Label]:
    """Return the label of each box, in their order.

    Args:
        boxes: Walls and obstacles.
        low: Lower left corner of the map [m].
        high: Upper right corner of the map [m].
        points_per_m: Scale of the map.
    """
    middle = 0.5 * (low + high)
    solids = [Rectangle(_point(points_per_m * _center(box)), _scaled(box, points_per_m), box.yaw_rad) for box in boxes]
    placed: list[Label] = []
    taken: list[Rectangle] = []
    for box in boxes:
        costs = []
        for label, facing, base_cost in _candidates(box):
            area = label.rectangle(points_per_m)
            corners = np.array(area.corners())
            outside = (corners < points_per_m * low).any() or (corners > points_per_m * high).any()
            cost = base_cost + _ON_A_NAME * sum(overlap(area, other) for other in taken) + _OUTSIDE * outside
            cost += _ON_A_BOX * sum(overlap(area, other) for other in solids)
            costs.append((cost, -float(facing @ (_center(box) - middle)), label))
        best = min(costs, key=lambda each: each[:2])[2]
        placed.append(best)
        taken.append(best.rectangle(points_per_m))
    return placed


def _candidates(box: Box) -> Iterator[tuple[Label, Array, float]]:
    """Yield places of the name of a box, with the direction from the box and the cost."""
    centre = _center(box)
    if box.kind == "wall":
        along = np.array([np.cos(box.yaw_rad), np.sin(box.yaw_rad)])
        across = np.array([-along[1], along[0]])
        turn = (np.degrees(box.yaw_rad) + 90.0) % 180.0 - 90.0
        for sign in (1.0, -1.0):
            side = centre + 0.5 * sign * box.size[1] * across
            for share in (0.0, 0.25, -0.25, 0.4, -0.4):
                label = Label(
                    box.name, _point(side + share * box.size[0] * along), _point(sign * GAP_PT * across), turn
                )
                yield label, sign * across, _FAR * abs(share)
        return
    x_m, y_m = np.abs(box.footprint() - centre).max(axis=0)
    width_pt = _text_size(box.name)[0]
    for sign in (1.0, -1.0):
        up, right = np.array([0.0, sign]), np.array([sign, 0.0])
        for shift in (0.0, 0.5, -0.5):
            offset = _point(GAP_PT * up + (shift * width_pt, 0.0))
            yield Label(box.name, _point(centre + y_m * up), offset, 0.0), up, _FAR * abs(shift)
        short = len(box.name) <= _SHORT_NAME
        beside = GAP_PT if short else 0.5 * GAP_PT + 0.5 * width_pt
        yield Label(box.name, _point(centre + x_m * right), _point(beside * right), 0.0), right, 0.0 if short else _FAR


def _text_size(name: str) -> tuple[float, float]:
    return _CHARACTER * FONT_PT * len(name), FONT_PT + 1.0


def _center(box: Box) -> Array:
    return np.array(box.center[:2], np.float64)


def _scaled(box: Box, points_per_m: float) -> tuple[float, float]:
    return points_per_m * box.size[0], points_per_m * box.size[1]


def _point(values: Array) -> Point:
    return float(values[0]), float(values[1])

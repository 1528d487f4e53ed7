"""An arena as a drawing gives it, and its YAML file."""

import math
from dataclasses import dataclass, field
from typing import Any

import yaml

Point = tuple[float, float]

MARGIN_M = 0.5
"""Floor around everything that is drawn."""
MAX_WALLS = 1000
"""Largest number of walls; every range sensor tests each of them."""


@dataclass
class Drawing:
    """Parts of an arena in metres, y upwards."""

    walls: list[tuple[Point, ...]] = field(default_factory=list)
    """Open rows of faces, each with the robot on its left."""
    rooms: list[tuple[Point, ...]] = field(default_factory=list)
    """Closed polygons around the robot."""
    pillars: list[tuple[Point, ...]] = field(default_factory=list)
    """Closed polygons beside the robot."""
    line: list[dict[str, Any]] = field(default_factory=list)
    """Pieces of the line, as an arena file has them."""
    line_width_m: float | None = None
    obstacles: list[tuple[str, Point, Point, float]] = field(default_factory=list)
    """Name, middle, length and width [m], and yaw [deg] of boxes."""
    ignored: list[str] = field(default_factory=list)
    """Descriptions of what is not used."""

    def wall_count(self) -> int:
        return sum(len(row) - 1 for row in self.walls) + sum(map(len, (*self.rooms, *self.pillars)))

    def is_empty(self) -> bool:
        return not (self.walls or self.rooms or self.pillars or self.line or self.obstacles)

    def moved_to_middle(self) -> "Drawing":
        """Return the drawing with the middle of its bounds at the origin of W."""
        points = self._points()
        x, y = (0.5 * (min(axis) + max(axis)) for axis in zip(*points, strict=True))

        def moved(point: Point) -> Point:
            return round(point[0] - x, 4) + 0.0, round(point[1] - y, 4) + 0.0  # no negative zeros

        def all_moved(outlines: list[tuple[Point, ...]]) -> list[tuple[Point, ...]]:
            return [tuple(moved(point) for point in outline) for outline in outlines]

        return Drawing(
            all_moved(self.walls),
            all_moved(self.rooms),
            all_moved(self.pillars),
            [
                {key: [*moved(value)] if key in {"start", "end", "center"} else value for key, value in piece.items()}
                for piece in self.line
            ],
            self.line_width_m,
            [(name, moved(center), size, yaw_deg) for name, center, size, yaw_deg in self.obstacles],
            self.ignored,
        )

    def arena(self, name: str, height_m: float, thickness_m: float) -> dict[str, Any]:
        """Return the arena as its YAML file has it; the middle of the drawing is at the origin."""
        reach_m = max(max(map(abs, point)) for point in self._points())
        line: dict[str, Any] = {"pieces": self.line}
        if self.line_width_m is not None:
            line = {"width_m": self.line_width_m, **line}
        common = {"height_m": height_m, "thickness_m": thickness_m}
        outlines = [
            *(("wall", "left", row) for row in self.walls),
            *(("room", "inside", outline) for outline in self.rooms),
            *(("pillar", "outside", outline) for outline in self.pillars),
        ]
        return {
            "name": name,
            "description": "Imported from a drawing",
            "floor": {"half_extent_m": math.ceil(10 * (reach_m + MARGIN_M)) / 10},
            "line": line,
            "polygons": [
                {"name": f"{kind}_{n}", "robot_is": robot, "points": [[*point] for point in points], **common}
                for n, (kind, robot, points) in enumerate(outlines, start=1)
            ],
            "obstacles": [
                {"name": box, "center": [*center], "size": [*size, 0.12], "yaw_deg": yaw_deg}
                for box, center, size, yaw_deg in self.obstacles
            ],
        }

    def _points(self) -> list[Point]:
        """Return points whose bounds contain everything."""
        points = [point for outline in (*self.walls, *self.rooms, *self.pillars) for point in outline]
        for piece in self.line:
            if piece["kind"] == "straight":
                points += [piece["start"], piece["end"]]
            else:
                (x, y), radius_m = piece["center"], piece["radius_m"]
                points += [(x - radius_m, y - radius_m), (x + radius_m, y + radius_m)]
        for _, (x, y), (length, width), _ in self.obstacles:
            half = 0.5 * math.hypot(length, width)
            points += [(x - half, y - half), (x + half, y + half)]
        return points


def arena_file_text(arena: dict[str, Any], source: str, remarks: list[str]) -> str:
    """Return the YAML text of an imported arena, with remarks as its comment."""
    comment = "".join(f"# {' '.join(line.split())}\n" for line in (f"Imported from {source}.", *remarks))
    return comment + yaml.safe_dump(arena, sort_keys=False, default_flow_style=None, width=120)

"""Obstacles that stand partly inside a wall, which no real arena has."""

import math
from collections.abc import Iterator

import numpy as np

from configs.schema.arena import Obstacle
from configs.schema.scenario import RunSpec
from pipeline.run_warnings.suspicion import Suspicion
from symolo.arena.footprints import Point, convex_outline, outlines_overlap, wall_footprint
from symolo.arena.mesh import unpacked

TOLERANCE_M = 0.001
"""Depth up to which an obstacle may reach into a wall, because places are written with rounded numbers."""


def inside_walls(spec: RunSpec) -> Iterator[Suspicion]:
    """Yield each wall and obstacle that share a part of the floor at the start of the run."""
    obstacles = [(obstacle, _smaller_outline(obstacle)) for obstacle in spec.arena.obstacles]
    for wall in spec.arena.walls:
        body = wall_footprint(wall)
        for index, (obstacle, outline) in enumerate(obstacles):
            if not outlines_overlap(body.corners(), outline):
                continue
            x, y = obstacle.center
            seen_by = "images and range sensors" if obstacle.solid else "images"
            yield Suspicion(
                f"{obstacle.name} inside wall {wall.name}",
                f"obstacle {obstacle.name} at x = {x:g}, y = {y:g} m stands partly inside wall {wall.name}, so that"
                f" {seen_by} see both in one place: move it (arena.obstacles.{index}.center), or let the wall end"
                " there",
            )


def _smaller_outline(obstacle: Obstacle) -> tuple[Point, ...]:
    """Return the corners around an obstacle on the floor, x and y [m] in W, moved inwards by the tolerance.

    Those of a thin obstacle are moved by a quarter of its thickness at most, so that they do not meet.
    """
    center, yaw_rad, size = obstacle.center, math.radians(obstacle.yaw_deg), np.array(obstacle.size[:2])
    corners = 0.5 * size * [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    if obstacle.mesh is not None:
        corners = unpacked(obstacle.mesh.packed).vertices[:, :2]
    smaller = corners * np.maximum(1.0 - 2.0 * TOLERANCE_M / size, 0.5)
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    return convex_outline([(x, y) for x, y in (center + smaller @ np.array([[c, s], [-s, c]])).tolist()])

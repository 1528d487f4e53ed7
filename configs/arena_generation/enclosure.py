"""The walls: a convex polygon around the line, each side with its own clearance."""

import numpy as np

from configs.arena_generation.rejection import BEYOND_THE_FLOOR, Rejected
from configs.schema.appearance.surface import SurfaceName
from configs.schema.arena import WallConfig
from configs.schema.arena_generator import ArenaGenerator
from symolo.core.arrays import Array

MIN_WALL_M = 0.20
"""Shortest wall; an attempt with a shorter one is rejected."""
UNEVEN = 0.25
"""Largest rotation of a side, as a share of the angle between two sides of an even polygon; a rectangle stays one."""


def draw_walls(
    recipe: ArenaGenerator, line: Array, half_extent_m: float, rng: np.random.Generator
) -> tuple[WallConfig, ...]:
    """Return walls counter-clockwise around the points (N, 2) of the line, with their faces inwards.

    Raises:
        Rejected: A side is too short, lies wholly outside the others, or ends beyond the floor.
    """
    count = recipe.walls
    if count == 0:
        return ()
    uneven = UNEVEN * rng.uniform(-1, 1, count) if count != 4 else np.zeros(count)
    angle = rng.uniform(0, 2 * np.pi) + 2 * np.pi * (np.arange(count) + uneven) / count
    clearance = rng.uniform(recipe.min_wall_clearance_m, recipe.max_wall_clearance_m, count)
    outwards = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    # Each side is a line n . p = reach: the extreme of the track in its direction, and its clearance.
    reach = (line @ outwards.T).max(axis=0) + clearance
    # Corners are the intersections of adjacent sides.
    corners = np.array([np.linalg.solve(outwards[[i - 1, i]], reach[[i - 1, i]]) for i in range(count)])
    sides = np.roll(corners, -1, axis=0) - corners
    along = np.stack([-outwards[:, 1], outwards[:, 0]], axis=1)
    if (sides * along).sum(axis=1).min() < MIN_WALL_M:
        raise Rejected("a wall is too short")
    surfaces: list[SurfaceName] = [recipe.surfaces[int(rng.integers(len(recipe.surfaces)))] for _ in range(count)]
    if np.abs(corners).max() > half_extent_m:
        raise Rejected(BEYOND_THE_FLOOR)
    return tuple(
        WallConfig(
            name=f"Wall_{i + 1}",
            start=_point(corners[i]),
            end=_point(corners[(i + 1) % count]),
            height_m=recipe.wall_height_m,
            surface=surfaces[i],
        )
        for i in range(count)
    )


def _point(at: Array) -> tuple[float, float]:
    return float(at[0]), float(at[1])

"""The walls: a convex polygon around the line, each side at its own clearance."""

import numpy as np

from configs.arena_generation.rejection import BEYOND_THE_FLOOR, Rejected
from configs.schema.arena import WallConfig
from configs.schema.arena_generator import ArenaGenerator
from configs.schema.surface import SurfaceName
from symolo.core.arrays import Array

MIN_WALL_M = 0.20
"""A shorter side is left to another attempt."""
UNEVEN = 0.25
"""Share of the even angle between two sides by which each may be turned; a rectangle stays one."""


def draw_walls(
    recipe: ArenaGenerator, line: Array, half_extent_m: float, rng: np.random.Generator
) -> tuple[WallConfig, ...]:
    """Walls counter-clockwise around the points (N, 2) of the line, their faces inwards.

    Raises:
        Rejected: A side comes out too short, lies wholly outside the others, or ends beyond the floor.
    """
    count = recipe.walls
    if count == 0:
        return ()
    uneven = UNEVEN * rng.uniform(-1, 1, count) if count != 4 else np.zeros(count)
    angle = rng.uniform(0, 2 * np.pi) + 2 * np.pi * (np.arange(count) + uneven) / count
    clearance = rng.uniform(recipe.min_wall_clearance_m, recipe.max_wall_clearance_m, count)
    outwards = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    reach = (line @ outwards.T).max(axis=0) + clearance
    # Each side meets the next one where both normals reach as far as they say.
    corners = np.array([np.linalg.solve(outwards[[i - 1, i]], reach[[i - 1, i]]) for i in range(count)])
    sides = np.roll(corners, -1, axis=0) - corners
    along = np.stack([-outwards[:, 1], outwards[:, 0]], axis=1)
    if (sides * along).sum(axis=1).min() < MIN_WALL_M:
        raise Rejected("a wall comes out too short")
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

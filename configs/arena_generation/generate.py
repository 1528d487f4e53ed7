"""Random arenas: attempts are drawn and checked until one has enough room everywhere."""

import math
from collections import Counter

import numpy as np

from configs.arena_generation.boxes import add_decoy, add_obstacle
from configs.arena_generation.enclosure import draw_walls
from configs.arena_generation.outline import draw_outline
from configs.arena_generation.rejection import BEYOND_THE_FLOOR, Rejected
from configs.arena_generation.site import SPACING_M, Site
from configs.schema.arena import ArenaConfig
from configs.schema.arena_generator import ArenaGenerator
from symolo.core.geometry.poses import PlanarPose

ATTEMPTS = 200
"""Number of attempts; if one attempt in twenty succeeds with a recipe, the recipe fails once in 28,000 arenas."""


class NoArenaError(Exception):
    """No attempt left enough room; the text contains the number of attempts and the most frequent reason."""


def generate_arena(config: ArenaConfig, start: PlanarPose, rng: np.random.Generator) -> ArenaConfig:
    """Return the arena in which line, walls and obstacles replace the recipe.

    Args:
        config: An arena with `generate`; floor, tape and name are kept.
        start: Pose at which the line is straight.
        rng: Random generator for all values.

    Raises:
        NoArenaError: The recipe leaves too little room.
    """
    if config.generate is None:
        return config
    reasons: Counter[str] = Counter()
    for _ in range(ATTEMPTS):
        try:
            site = _attempt(config.generate, config.floor.half_extent_m, start, rng)
        except Rejected as rejected:
            reasons[str(rejected)] += 1
            continue
        return config.model_copy(
            update={
                "generate": None,
                "line": config.line.model_copy(update={"pieces": site.track.pieces()}),
                "walls": site.walls,
                "obstacles": (*site.obstacles, *site.decoys),
            }
        )
    reason, count = reasons.most_common(1)[0]
    raise NoArenaError(f"none of {ATTEMPTS} attempts at an arena succeeded; {count} of them failed because {reason}")


def _attempt(recipe: ArenaGenerator, half_extent_m: float, start: PlanarPose, rng: np.random.Generator) -> Site:
    track = draw_outline(recipe, start, rng)
    line = track.poses(np.linspace(0.0, track.length_m, math.ceil(track.length_m / SPACING_M)))[:, :2]
    walls = draw_walls(recipe, line, half_extent_m, rng)
    if not walls and np.abs(line).max() + recipe.clearance.beside_m > half_extent_m:
        raise Rejected(BEYOND_THE_FLOOR)
    site = Site(track, walls, half_extent_m, recipe.clearance)
    for _ in range(recipe.max_obstacles):
        add_obstacle(site, recipe, rng)
    if len(site.obstacles) < recipe.min_obstacles:
        raise Rejected("there is no room to pass so many obstacles")
    for _ in range(recipe.max_decoys):
        add_decoy(site, recipe, rng)
    return site

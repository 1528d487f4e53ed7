"""Random boxes: obstacles on straight parts of the line, and decoys next to it."""

import math

import numpy as np

from configs.arena_generation.site import Site
from configs.schema.arena import Obstacle
from configs.schema.arena_generator import ArenaGenerator
from symolo.core.geometry.poses import PlanarPose

MAX_PLACES = 40
"""Number of places that are tried for one box before it is left out."""
MIN_HEIGHT_M, MAX_HEIGHT_M = 0.12, 0.16
"""Limits of the height; a lower box covers only a part of the beams of the range sensors and is detected late."""


def add_obstacle(site: Site, recipe: ArenaGenerator, rng: np.random.Generator) -> None:
    """Place one more obstacle on the line, if there is room for it."""
    limits, offsets = recipe.clearance, site.track.offsets.tolist()
    straights = [
        (offsets[i] + limits.before_m, offsets[i + 1] - limits.after_m)
        for i, segment in enumerate(site.track.segments)
        if segment.curvature_1_m == 0 and segment.length_m >= limits.before_m + limits.after_m
    ]
    if not straights:
        return
    for _ in range(MAX_PLACES):
        at_m = rng.uniform(*straights[int(rng.integers(len(straights)))])
        x, y, yaw = site.track.poses(np.array([at_m]))[0].tolist()
        aside_m = recipe.max_obstacle_offset_m * rng.uniform(-1, 1)
        turned_rad = math.radians(recipe.max_obstacle_yaw_deg) * rng.uniform(-1, 1)
        sizes = (recipe.min_obstacle_m, recipe.max_obstacle_m)
        pose = (x - aside_m * math.sin(yaw), y + aside_m * math.cos(yaw), yaw + turned_rad)
        box = _box(f"Obstacle_{len(site.obstacles) + 1}", pose, sizes, recipe, rng)
        if site.put_obstacle(box, at_m):
            return


def add_decoy(site: Site, recipe: ArenaGenerator, rng: np.random.Generator) -> None:
    """Place one more decoy next to the line, if there is room for it."""
    for _ in range(MAX_PLACES):
        x, y, yaw = site.track.poses(rng.uniform(0, site.track.length_m, 1))[0].tolist()
        aside_m = rng.choice([-1.0, 1.0]) * rng.uniform(recipe.clearance.beside_m, recipe.max_decoy_distance_m)
        pose = (x - aside_m * math.sin(yaw), y + aside_m * math.cos(yaw), rng.uniform(-math.pi, math.pi))
        sizes = (recipe.min_decoy_m, recipe.max_decoy_m)
        if site.put_decoy(_box(f"Decoy_{len(site.decoys) + 1}", pose, sizes, recipe, rng)):
            return


def _box(
    name: str, pose: PlanarPose, sizes: tuple[float, float], recipe: ArenaGenerator, rng: np.random.Generator
) -> Obstacle:
    length_m, width_m = rng.uniform(*sizes, 2).tolist()
    return Obstacle(
        name=name,
        center=pose[:2],
        size=(length_m, width_m, rng.uniform(MIN_HEIGHT_M, MAX_HEIGHT_M)),
        yaw_deg=math.degrees(math.remainder(pose[2], 2 * math.pi)),
        surface=recipe.surfaces[int(rng.integers(len(recipe.surfaces)))],
    )

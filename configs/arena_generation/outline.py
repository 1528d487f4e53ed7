"""The closed line: a random polygon with rounded corners, placed so that it is straight at the start."""

import math

import numpy as np

from configs.arena_generation.rejection import Rejected
from configs.arena_generation.track import Segment, Track
from configs.schema.arena_generator import ArenaGenerator
from symolo.core.arrays import Array
from symolo.core.geometry.poses import PlanarPose

START_BEHIND_M, START_AHEAD_M = 0.20, 0.45
"""Lengths of straight line behind and ahead of the start; `physics.run.lap` closes a lap on the second one."""
MIN_TURN_RAD = math.radians(5.0)
"""Smallest turn of a corner."""
MAX_EDGE_SHARE = 0.45
"""Largest share of an edge for the bend at one of its ends, so that a straight remains between two bends."""


def draw_outline(recipe: ArenaGenerator, start: PlanarPose, rng: np.random.Generator) -> Track:
    """Return a closed track that begins on a straight, behind the start.

    Raises:
        Rejected: The bends do not fit between the corners, or no straight is long enough for the start.
    """
    track = rounded(_polygon(recipe, rng), recipe, rng)
    straights = [i for i, segment in enumerate(track.segments) if segment.curvature_1_m == 0]
    long = [i for i in straights if track.segments[i].length_m >= START_BEHIND_M + START_AHEAD_M]
    if not long:
        raise Rejected("no straight is long enough for the start")
    first = long[int(rng.integers(len(long)))]
    behind_m = rng.uniform(START_BEHIND_M, track.segments[first].length_m - START_AHEAD_M)
    x, y, yaw = start
    begin = (x - behind_m * math.cos(yaw), y - behind_m * math.sin(yaw), yaw)
    laid = Track(begin, track.segments[first:] + track.segments[:first], behind_m)
    # Not every polygon is counter-clockwise: all corners of a triangle may lie on one side of its middle.
    clockwise = sum(segment.length_m * segment.curvature_1_m for segment in laid.segments) < 0
    return laid if clockwise == recipe.clockwise else laid.mirrored()


def _polygon(recipe: ArenaGenerator, rng: np.random.Generator) -> Array:
    """Return corners (N, 2), counter-clockwise as seen from the middle; the middle may be outside the polygon."""
    count, uneven = recipe.corners, recipe.irregularity
    angle = 2 * np.pi * (np.arange(count) + 0.5 * uneven * rng.uniform(-1, 1, count)) / count
    distance = recipe.radius_m * (1 + uneven * rng.uniform(-1, 1, count))
    stretch = math.sqrt(recipe.elongation)
    turned = rng.uniform(0, 2 * np.pi)
    return distance[:, None] * np.stack([stretch * np.cos(angle + turned), np.sin(angle + turned) / stretch], axis=1)


def rounded(corners: Array, recipe: ArenaGenerator, rng: np.random.Generator) -> Track:
    """Return the track along a polygon (N, 2) with an arc in each corner; it begins with the first straight.

    An arc of radius r replaces the last r tan(turn / 2) of both edges at its corner.
    """
    edges = np.roll(corners, -1, axis=0) - corners
    length, yaw = np.hypot(edges[:, 0], edges[:, 1]), np.arctan2(edges[:, 1], edges[:, 0])
    turn = (yaw - np.roll(yaw, 1) + np.pi) % (2 * np.pi) - np.pi
    if np.abs(turn).min() < MIN_TURN_RAD:
        raise Rejected("a corner is too flat")
    per_radius = np.tan(0.5 * np.abs(turn))
    max_radius = MAX_EDGE_SHARE * np.minimum(length, np.roll(length, 1)) / per_radius
    if max_radius.min() < recipe.min_bend_radius_m:
        raise Rejected("the bends do not fit between the corners")
    radius = rng.uniform(recipe.min_bend_radius_m, np.minimum(max_radius, recipe.max_bend_radius_m))
    taken = radius * per_radius
    segments: list[Segment] = []
    for here, there in zip(range(len(corners)), np.roll(range(len(corners)), -1), strict=True):
        segments.append(Segment(float(length[here] - taken[here] - taken[there]), 0.0))
        curvature = math.copysign(1 / radius[there], turn[there])
        segments.append(Segment(float(radius[there] * abs(turn[there])), curvature))
    x, y = corners[0] + taken[0] * np.array([np.cos(yaw[0]), np.sin(yaw[0])])
    return Track((float(x), float(y), float(yaw[0])), tuple(segments))

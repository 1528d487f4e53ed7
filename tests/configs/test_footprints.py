"""The rectangles of the start check against the arena's own boxes and against closed forms."""

import math

import numpy as np
import pytest

from configs.footprints import corners, overlap, wall_corners
from configs.schema.arena import ArenaConfig, Line, Obstacle, Wall
from physics.arena import Arena


def test_footprints_are_those_of_the_arena_that_is_simulated():
    wall = Wall(name="W", start=(-0.5, 0.9), end=(0.3, 0.2), thickness_m=0.03)
    obstacle = Obstacle(name="O", center=(0.4, -0.6), size=(0.3, 0.1, 0.2), yaw_deg=25.0)
    arena = Arena.from_config(ArenaConfig(name="a", line=Line(), walls=(wall,), obstacles=(obstacle,)))
    ours = [wall_corners(wall), corners(obstacle.center, obstacle.size[:2], obstacle.yaw_deg)]
    for box, rectangle in zip(arena.boxes, ours, strict=True):
        expected = sorted(map(tuple, np.round(box.footprint(), 9)))
        assert sorted(map(tuple, np.round(rectangle, 9))) == expected


@pytest.mark.parametrize("yaw_deg", [0.0, 30.0, 77.0])
def test_rectangles_meet_when_their_sides_pass_each_other(yaw_deg: float):
    """Side by side along their own x: 0.2 and 0.1 long, so they touch at a distance of 0.15."""
    yaw = math.radians(yaw_deg)
    one = corners((0.3, -0.2), (0.2, 0.1), yaw_deg)
    for distance, meets in ((0.15 - 1e-6, True), (0.15 + 1e-6, False)):
        center = (0.3 + distance * math.cos(yaw), -0.2 + distance * math.sin(yaw))
        other = corners(center, (0.1, 0.4), yaw_deg)
        assert overlap(one, other) is meets
        assert overlap(other, one) is meets


def test_a_corner_meets_a_side_where_half_the_diagonal_reaches():
    """A unit square turned by 45 degrees reaches sqrt(2) / 2 along x."""
    for gap, meets in ((-1e-6, True), (1e-6, False)):
        turned = corners((0.5 + math.sqrt(0.5) + gap, 0.1), (1, 1), 45)
        assert overlap(corners((0, 0), (1, 1), 0), turned) is meets


def test_a_rectangle_inside_another_meets_it():
    assert overlap(corners((0, 0), (2, 2), 10), corners((0.1, 0), (0.1, 0.1), 50))

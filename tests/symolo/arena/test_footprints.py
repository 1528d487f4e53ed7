"""Rectangles on the floor against closed forms."""

import math

import numpy as np
import pytest

from configs.schema.arena import WallConfig
from symolo.arena.footprints import Rectangle, outlines_overlap, overlap, swept, wall_footprint


def rectangle(center, size, yaw_deg):
    return Rectangle(center, size, math.radians(yaw_deg))


def test_a_wall_lies_to_the_right_of_its_face():
    """A face from (1, 1) to (1, 3) points along +y; its body is 0.2 thick towards +x."""
    rectangle = wall_footprint(WallConfig(name="W", start=(1.0, 1.0), end=(1.0, 3.0), thickness_m=0.2))
    expected = [(1.0, 1.0), (1.0, 3.0), (1.2, 1.0), (1.2, 3.0)]
    np.testing.assert_allclose(sorted(np.round(rectangle.corners(), 12).tolist()), expected, atol=1e-12)


@pytest.mark.parametrize("yaw_deg", [0.0, 30.0, 77.0])
def test_rectangles_meet_when_their_sides_pass_each_other(yaw_deg: float):
    """Side by side along their own x: 0.2 and 0.1 long, so they touch at a distance of 0.15."""
    yaw = math.radians(yaw_deg)
    one = rectangle((0.3, -0.2), (0.2, 0.1), yaw_deg)
    for distance, meets in ((0.15 - 1e-6, True), (0.15 + 1e-6, False)):
        center = (0.3 + distance * math.cos(yaw), -0.2 + distance * math.sin(yaw))
        other = rectangle(center, (0.1, 0.4), yaw_deg)
        assert overlap(one, other) is meets
        assert overlap(other, one) is meets


def test_a_corner_meets_a_side_where_half_the_diagonal_reaches():
    """A unit square turned by 45 degrees reaches sqrt(2) / 2 along x."""
    for gap, meets in ((-1e-6, True), (1e-6, False)):
        turned = rectangle((0.5 + math.sqrt(0.5) + gap, 0.1), (1, 1), 45)
        assert overlap(rectangle((0, 0), (1, 1), 0), turned) is meets


def test_a_rectangle_inside_another_meets_it():
    assert overlap(rectangle((0, 0), (2, 2), 10), rectangle((0.1, 0), (0.1, 0.1), 50))


def test_the_way_of_a_square_along_a_diagonal_is_a_hexagon():
    """From (0, 0) to (3, 3): the corners of the band that a unit square sweeps, and nothing beside it."""
    (outline,) = swept(rectangle((0, 0), (1, 1), 0), rectangle((3, 3), (1, 1), 0))
    expected = [(-0.5, -0.5), (0.5, -0.5), (3.5, 2.5), (3.5, 3.5), (2.5, 3.5), (-0.5, 0.5)]
    np.testing.assert_allclose(outline, expected, atol=1e-12)
    beside = rectangle((2.0, 0.9), (0.08, 0.08), 0)  # its nearest corner is (1.96, 0.94), and the band is y > x - 1
    assert not outlines_overlap(outline, beside.corners())
    assert outlines_overlap(outline, rectangle((1.9, 1.0), (0.08, 0.08), 0).corners())


def test_the_way_of_a_turning_square_reaches_as_far_as_its_corner():
    outlines = swept(rectangle((0, 0), (1, 1), 0), rectangle((0, 0), (1, 1), 90))
    reach = max(x for outline in outlines for x, _ in outline)
    assert reach == pytest.approx(math.sqrt(0.5))

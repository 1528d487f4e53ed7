"""Functions of the place of both wheels: together they are the response to the same friction everywhere."""

import numpy as np
import pytest

from diagnosis.predictors.wheels.count_noise import CountNoise
from diagnosis.predictors.wheels.floor_loads import MAX_CELLS, UNDER_MIDDLE, floor_loads

ROWS, TRACK_M = 80, 0.2
GOES_ON = np.arange(ROWS) % 40 < 39


def loads_of(poses, signs=None):
    """Functions of the left and the right wheel of two trials of 40 rows."""
    known = np.ones(ROWS, dtype=bool)
    noises = [
        CountNoise.from_rounding(np.full(ROWS, 0.1), np.arange(ROWS) % 40 > 0, known, keep, 0.2) for keep in (0.3, 0.6)
    ]
    signs = [np.ones(ROWS)] * 2 if signs is None else signs
    return list(floor_loads(poses, TRACK_M, signs, noises, GOES_ON)), noises


@pytest.fixture
def circles():
    """Poses of two rounds of a circle with a radius of 0.5 m."""
    angle = 2.0 * np.pi * np.arange(ROWS) / 40.0
    return np.stack([0.5 * np.cos(angle), 0.5 * np.sin(angle), angle + 0.5 * np.pi], axis=-1)


def test_all_cells_together_are_the_response_to_the_same_friction_everywhere(circles):
    signs = [np.where(np.arange(ROWS) < 20, -1.0, 1.0), np.ones(ROWS)]
    loads, noises = loads_of(circles, signs)
    assert len(loads) == 28
    for both in loads:
        sizes = set()
        for wheel, sign, noise in zip(both, signs, noises, strict=True):
            responses = wheel.responses()
            sizes.add(responses.shape[1])
            expected = noise.response(-sign[:, None] * GOES_ON[:, None])[:, 0]
            np.testing.assert_allclose(responses.sum(axis=1), expected, atol=1e-9)
        assert len(sizes) == 1
        assert sizes.pop() <= MAX_CELLS


def test_a_strip_acts_on_the_wheel_that_crosses_it(circles):
    """The left wheel, on the inner circle of 0.4 m, never comes to where the right one is at 0.6 m."""
    loads, _ = loads_of(circles)
    left, right = next(both for both in loads if both[0].what == "friction that depends on x")
    assert not left.responses()[:, -1].any()
    rows = np.flatnonzero(right.responses()[:, -1])
    assert set(rows) & {0, 39, 40, 79}


def test_under_the_middle_both_wheels_have_the_same_place(circles):
    loads, noises = loads_of(circles)
    left, right = next(both for both in loads if both[0].what.endswith(UNDER_MIDDLE))
    load = np.zeros((ROWS, 1))
    load[10] = 1.0
    ratio = noises[0].response(load)[10, 0] / noises[1].response(load)[10, 0]
    np.testing.assert_allclose(left.responses()[0], ratio * right.responses()[0], atol=1e-12)


def test_rows_without_a_pose_have_no_place(circles):
    circles[:40] = np.nan
    loads, _ = loads_of(circles)
    for left, right in loads:
        assert not left.responses()[:40].any()
        assert right.responses()[40:].any()


def test_without_a_heading_only_the_middle_has_a_place(circles):
    circles[:, 2] = np.nan
    loads, _ = loads_of(circles)
    assert loads
    assert all(both[0].what.endswith(UNDER_MIDDLE) for both in loads)


def test_a_robot_that_stands_still_says_nothing_of_the_floor():
    assert loads_of(np.zeros((ROWS, 3)))[0] == []
    assert loads_of(np.full((ROWS, 3), np.nan))[0] == []

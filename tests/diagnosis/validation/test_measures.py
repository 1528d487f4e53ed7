import math

import numpy as np
import pytest

from diagnosis.validation.measures import first_reached


def test_a_level_is_reached_on_the_straight_between_two_points():
    x, y = np.array([0.0, 1.0, 3.0, 4.0]), np.array([0.0, 0.2, 0.8, 1.0])
    assert first_reached(x, y, 0.5) == pytest.approx(2.0)
    assert first_reached(x, y, 0.2) == pytest.approx(1.0)


def test_of_several_the_first_one_counts():
    assert first_reached(np.arange(4.0), np.array([0.0, 1.0, 0.0, 1.0]), 0.25) == pytest.approx(0.25)


@pytest.mark.parametrize("level", [0.0, -1.0, 1.5])
def test_a_level_that_is_out_of_reach_or_there_from_the_start_has_no_place(level):
    assert math.isnan(first_reached(np.arange(3.0), np.array([0.0, 0.5, 1.0]), level))

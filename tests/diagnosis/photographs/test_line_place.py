"""Where a line is, in images whose line was drawn."""

import cv2
import numpy as np
import pytest

from diagnosis.photographs.line_place import find_lines
from tests.known_photographs import photograph


def middle_at(place, row):
    return float(np.interp(row, place.rows_px, place.x_px))


@pytest.mark.parametrize(("line", "floor", "is_dark"), [(0.06, 0.42, True), (0.6, 0.1, False)])
def test_dark_and_light_lines_are_where_they_were_drawn(line, floor, is_dark):
    images = [photograph(k, line=line, floor=floor, slant=0.3) for k in range(3)]
    for k, place in enumerate(find_lines(images)):
        drawn = 79.5 + np.random.Generator(np.random.PCG64(k)).uniform(-8, 8)
        assert place.is_dark is is_dark
        assert not place.is_turned
        assert middle_at(place, 59.5) == pytest.approx(drawn, abs=1.0)
        assert place.width_px == pytest.approx(36, abs=2)


@pytest.mark.parametrize("taper", [-0.12, 0.0, 0.12])
def test_the_edges_of_a_line_that_tapers_are_where_they_were_drawn(taper):
    """A width of 36 px in the middle that changes by 12 px over 100 rows."""
    (place,) = find_lines([photograph(1, width_px=36.0, taper=taper, slant=0.1)])
    rows = np.linspace(place.rows_px[0], place.rows_px[-1], 20)
    middle = 79.5 + np.random.Generator(np.random.PCG64(1)).uniform(-8, 8) + 0.1 * (rows - 59.5)
    half = 0.5 * (36.0 + taper * (rows - 59.5))
    left, right = place.edges_px(rows)
    assert np.abs(left - (middle - half)).max() < 1.5
    assert np.abs(right - (middle + half)).max() < 1.5


def test_a_line_from_left_to_right_is_measured_in_the_turned_image():
    (place,) = find_lines([np.ascontiguousarray(photograph(1).transpose(1, 0, 2))])
    assert place.is_turned
    assert place.image.shape == (120, 160, 3)


def test_all_photographs_have_the_same_kind_of_line():
    """The second image has a lighter strip of paper that is clearer than its dark line."""
    paper = photograph(2, line=0.15)
    paper[:, 110:135] = 250
    places = find_lines([photograph(1, line=0.01), paper, photograph(3, line=0.01)])
    assert [place.is_dark for place in places] == [True, True, True]
    assert abs(middle_at(places[1], 60) - 79.5) < 10


def test_an_image_without_a_line_has_none():
    even = cv2.GaussianBlur(np.random.Generator(np.random.PCG64(1)).uniform(90, 160, (120, 160, 3)), (0, 0), 8)
    box = photograph(1, line=0.42)
    box[40:80, 60:100] = 30
    assert find_lines([even.astype(np.uint8)]) == (None,)
    assert find_lines([box]) == (None,)

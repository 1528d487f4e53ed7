"""A line through points: its straights and arcs, against closed forms."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from configs.draw import draw_run
from configs.loader import load_scenario, section_of
from configs.schema.arena import ArenaConfig
from symolo.arena.geometry import Arena
from symolo.core.errors import InputError

SQUARE = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
EIGHT = [[0.0, 0.0], [0.6, 0.5], [1.2, 0.0], [0.6, -0.5], [0.0, 0.0], [-0.6, 0.5], [-1.2, 0.0], [-0.6, -0.5]]


def section(**course):
    return section_of("arena", {"name": "mine", "line": {"course": course}}, "test").tree


def line(**course):
    return Arena.from_config(ArenaConfig.model_validate(section(**course))).line


def ends(piece):
    """First and last point of a piece, and the directions there."""
    s = np.array([0.0, 1e-6, piece.length_m - 1e-6, piece.length_m])
    points = piece.at(s)
    return points[0], points[-1], points[1] - points[0], points[-1] - points[-2]


def assert_smooth(pieces, *, closed, within_deg=0.01):
    """Each piece begins where the one before it ends, in the same direction."""
    following = [*pairwise(pieces), *([(pieces[-1], pieces[0])] if closed else [])]
    for before, after in following:
        _, end, _, yaw_end = ends(before)
        start, _, yaw_start, _ = ends(after)
        assert end == pytest.approx(start, abs=1e-6)
        cosine = float(yaw_end @ yaw_start) / np.linalg.norm(yaw_end) / np.linalg.norm(yaw_start)
        assert cosine > math.cos(math.radians(within_deg)) - 1e-9


@pytest.mark.parametrize("points", [SQUARE, SQUARE[::-1], [*SQUARE, SQUARE[0]]], ids=["left", "right", "repeated"])
def test_a_rounded_square_has_four_straights_and_four_quarter_circles(points):
    square = line(points=points, bend_radius_m=0.3)
    assert len(square.pieces) == 8
    assert square.length_m == pytest.approx(4 * 1.4 + 2 * math.pi * 0.3, abs=1e-5)
    assert_smooth(square.pieces, closed=True)
    start, *_ = ends(square.pieces[0])
    assert start == pytest.approx(np.array(points[0]) + 0.3 * np.sign(np.array(points[1]) - points[0]))


def test_an_open_line_begins_and_ends_at_its_points():
    corner = line(points=[[0, 0], [1, 0], [1, 1]], closed=False)
    assert [type(piece).__name__ for piece in corner.pieces] == ["Straight", "Arc", "Straight"]
    assert ends(corner.pieces[0])[0] == pytest.approx([0, 0])
    assert ends(corner.pieces[-1])[1] == pytest.approx([1, 1])
    assert corner.length_m == pytest.approx(2 * 0.85 + 0.5 * math.pi * 0.15, abs=1e-6)
    assert len(line(points=[[0, 0], [1, 0], [2, 0]], closed=False).pieces) == 2  # no corner, no arc


def test_a_spline_is_within_a_tenth_of_a_millimetre_of_the_curve_and_has_no_corner():
    points = np.array(EIGHT)
    steps = np.sqrt(np.hypot(*np.diff([*points, points[0]], axis=0).T))
    curve = CubicSpline(np.append(0.0, np.cumsum(steps)), [*points, points[0]], bc_type="periodic")
    eight = line(points=EIGHT, shape="spline")
    assert_smooth(eight.pieces, closed=True, within_deg=0.5)  # an arc of more than 5 m is a straight
    dense = curve(np.linspace(0, curve.x[-1], 4000))
    away_m = np.full(len(dense), np.inf)
    for piece in eight.pieces:
        s, offset = piece.local(dense)
        beside = (s >= -1e-3) & (s <= piece.length_m + 1e-3)
        away_m[beside] = np.minimum(away_m[beside], np.abs(offset[beside]))
    assert away_m.max() < 1e-4
    assert eight.length_m == pytest.approx(np.hypot(*np.diff(dense, axis=0).T).sum(), rel=1e-4)


def test_a_spline_through_points_of_a_circle_is_almost_that_circle():
    angle = np.arange(16) * math.pi / 8
    circle = line(points=np.column_stack((np.cos(angle), np.sin(angle))).tolist(), shape="spline")
    assert circle.length_m == pytest.approx(2 * math.pi, rel=1e-4)
    radii = [piece.radius_m for piece in circle.pieces]
    assert min(radii) > 0.98
    assert max(radii) < 1.02


@pytest.mark.parametrize("radius_m", [0.05, 0.3, 0.4])
def test_points_of_a_recorded_path_as_close_as_allowed_are_a_line(radius_m):
    count = min(500, int(2 * math.pi * radius_m / 0.00501))
    angle = 2 * math.pi * np.arange(count) / count
    circle = line(points=(radius_m * np.column_stack((np.cos(angle), np.sin(angle)))).tolist(), shape="spline")
    assert circle.length_m == pytest.approx(2 * math.pi * radius_m, rel=1e-4)
    assert len(circle.strips) == 1


def test_a_course_replaces_the_pieces_that_a_file_extends_and_scales(tmp_path):
    scenario = load_scenario("smoke", ["arena.line={course: {points: [[-1, -1], [1, -1], [1, 1]]}, pieces: []}"])
    run = draw_run(scenario, "CW", 1)
    assert len(run.arena.line.pieces) == 6
    assert "course" not in run.model_dump_json()
    path = tmp_path / "mine.yaml"
    path.write_text("extends: classroom\nname: mine\nline: {course: {points: [[-1, -1], [1, -1], [1, 1]]}}\n")
    half = section_of("arena", {"extends": str(path), "scale": 0.5, "name": "half"}, "test").tree
    assert [piece.get("radius_m") for piece in half["line"]["pieces"]] == [None, 0.075] * 3
    back = section_of("arena", {"extends": str(path), "line": {"pieces": []}, "name": "none"}, "test").tree
    assert back["line"]["pieces"] == []


@pytest.mark.parametrize(
    ("course", "message"),
    [
        ({"points": [[0, 0]]}, r"arena\.line\.course\.points: got .*at least 2 items"),
        ({"points": [[0, 0], [1, 0]]}, "a closed line has at least three points; write more points, or closed: false"),
        ({"points": [[0, 0], [{"uniform": [1, 2]}, 0]]}, r"no distribution is allowed here; .*use arena\.generate"),
        ({"points": [*SQUARE[:2], *SQUARE[1:]]}, r"points 2 and 3 are the same, \(1, -1\); remove one of them"),
        (
            {"points": SQUARE, "bend_radius_m": 1.2},
            r"between point 1 at \(-1, -1\).*bend_radius_m: 1 or less",
        ),
        ({"points": [[0, 0], [1, 0], [0, 0.001]]}, "move the points apart, or turn less sharply there"),
        ({"points": [[0, 0], [0.02, 0.02], [0.04, 0]], "shape": "spline"}, "bends to a radius of .* mm at"),
        (
            {"points": [[0, 0], [0.002, 0], [1, 1]], "shape": "spline"},
            r"point 1 at \(0, 0\) .* are 2 mm apart; leave out",
        ),
        ({"points": [[0, 0], [1, 0]], "shape": "spline", "closed": False}, "a spline through two points is a straight"),
        ({"points": SQUARE, "radius_m": 0.2}, "radius_m: unknown key.*bend_radius_m"),
    ],
)
def test_a_course_along_which_no_line_can_be_laid_is_refused(course, message):
    with pytest.raises(InputError, match=message):
        section(**course)


def test_points_beside_pieces_are_refused():
    pieces = [{"kind": "straight", "start": [0, 0], "end": [1, 0]}]
    with pytest.raises(InputError, match="both course and pieces; remove one of them"):
        section_of("arena", {"name": "mine", "line": {"course": {"points": SQUARE}, "pieces": pieces}}, "test")

"""Arenas from drawings: what is drawn in millimetres stands in the arena in metres, with y upwards."""

import math
from pathlib import Path

import cv2
import numpy as np
import pytest

from configs.arena_import.drawing import MAX_WALLS
from configs.arena_import.floor_plan import drawing_from_image
from configs.arena_import.svg import drawing_from_svg
from configs.loader import load_section
from symolo.arena.geometry import Arc, Arena, Straight
from symolo.core.errors import InputError

EXAMPLE = Path(__file__).parents[3] / "examples/track.svg"
HEAD = '<svg xmlns="http://www.w3.org/2000/svg" {size} viewBox="0 0 1000 500">{body}</svg>'


def svg(body, size='width="1000mm" height="500mm"', width_m=None):
    return drawing_from_svg(HEAD.format(body=body, size=size).encode(), "plan.svg", width_m)


def test_the_example_is_a_closed_track_within_a_room(tmp_path, symolo):
    out = tmp_path / "track.yaml"
    ended = symolo("arena", "import", EXAMPLE, "--out", out)
    assert ended.code == 0
    assert "9 walls, 1 room, 1 pillar, 1 obstacle, a line of 8 pieces" in ended.out
    again = symolo("arena", "import", EXAMPLE, "--out", out)
    assert again.code == 2
    assert "track.yaml: exists already; name another file with --out, or remove this one" in again.err
    arena = Arena.from_config(_config(out))
    straights = [piece for piece in arena.line.pieces if isinstance(piece, Straight)]
    arcs = [piece for piece in arena.line.pieces if isinstance(piece, Arc)]
    assert [round(arc.radius_m, 6) for arc in arcs] == [0.3] * 4
    assert sum(straight.length_m for straight in straights) == pytest.approx(2 * 1.2 + 2 * 0.6)
    assert arena.line.length_m == pytest.approx(3.6 + 2.0 * math.pi * 0.3, rel=1e-4)
    assert arena.line.width_m == 0.015
    ends = [piece.at(np.array([0.0, piece.length_m])) for piece in arena.line.pieces]
    for one, other in zip(ends, [*ends[1:], ends[0]], strict=True):
        np.testing.assert_allclose(one[1], other[0], atol=1e-3)
    room = [box for box in arena.boxes if box.name.startswith("room")]
    # Faces of 2.36 x 1.76 m about the middle, bodies of 10 mm behind them.
    assert sorted(round(max(abs(np.array(box.center[:2]))), 4) for box in room) == [0.885, 0.885, 1.185, 1.185]
    (obstacle,) = [box for box in arena.boxes if box.kind == "obstacle"]
    assert obstacle.size == pytest.approx((0.08, 0.10, 0.12))
    assert obstacle.center[:2] == pytest.approx((0.0, 0.6))


def _config(path):
    from configs.schema.arena import ArenaConfig  # noqa: PLC0415

    return ArenaConfig.model_validate(load_section("arena", str(path)).tree)


def test_transformations_layers_and_a_given_width_hold():
    body = '<g class="walls" transform="translate(100 0) scale(2)"><line x1="0" y1="10" x2="100" y2="10"/></g>'
    (wall,) = svg(body).walls
    np.testing.assert_allclose(wall, ((0.1, -0.02), (0.3, -0.02)), atol=1e-6)
    (half,) = svg(body, size='width="1000" height="500"', width_m=0.5).walls
    assert half[1] == pytest.approx((0.15, -0.01))
    label = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" inkscape:label="My room"'
    drawing = svg(f'<g {label}><polygon points="0,0 100,0 0,100"/></g><circle id="logo" r="9"/>')
    assert [len(points) for points in drawing.rooms] == [3]
    assert drawing.ignored == ["logo"]


def _points(pieces):
    """Points along straights and arcs as an arena file has them."""
    for piece in pieces:
        if piece["kind"] == "straight":
            yield from np.linspace(piece["start"], piece["end"], 20)
        else:
            angle = np.radians(np.linspace(piece["start_deg"], piece["end_deg"], 20))
            circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
            yield from np.array(piece["center"]) + piece["radius_m"] * circle


@pytest.mark.parametrize(
    ("path", "controls"),
    [
        ("M 0 100 C 100 0 200 0 300 100", [(0.0, -0.1), (0.1, 0.0), (0.2, 0.0), (0.3, -0.1)]),
        ("M 0 100 Q 150 0 300 100", [(0.0, -0.1), (0.15, 0.0), (0.3, -0.1)]),
    ],
    ids=["cubic", "quadratic"],
)
def test_a_curve_is_a_row_of_joined_arcs_on_it(path, controls):
    drawing = svg(f'<path id="line" d="{path}"/>')
    assert {piece["kind"] for piece in drawing.line} == {"arc"}
    assert [piece.get("joined", False) for piece in drawing.line] == [False] + [True] * (len(drawing.line) - 1)
    t, degree = np.linspace(0.0, 1.0, 4001)[:, None], len(controls) - 1
    bezier = sum(math.comb(degree, k) * t**k * (1 - t) ** (degree - k) * p for k, p in enumerate(np.array(controls)))
    points = np.array(list(_points(drawing.line)))
    assert np.hypot(*(points[:, None] - bezier[None]).transpose(2, 0, 1)).min(axis=1).max() < 1e-4
    assert points[0] == pytest.approx(controls[0], abs=1e-6)
    assert points[-1] == pytest.approx(controls[-1], abs=1e-6)


@pytest.mark.parametrize("path", ["M 0 0 C 0 0 100 0 100 100", "M 0 0 C 1 0 0 1 1 1", "M 0 0 A 100 50 0 0 1 200 0"])
def test_a_curve_to_which_no_arcs_fit_is_a_row_of_joined_straights(path):
    """Its first direction is undefined, it bends to less than 2 cm, or it is an ellipse."""
    pieces = svg(f'<path id="line" d="{path}"/>').line
    assert {piece["kind"] for piece in pieces} == {"straight"}
    assert all(math.dist(piece["start"], piece["end"]) < 0.04 for piece in pieces)
    assert [piece.get("joined", False) for piece in pieces] == [False] + [True] * (len(pieces) - 1)


@pytest.mark.parametrize(
    ("body", "options", "message"),
    [
        ('<rect id="a" width="9" height="9"/>', {}, "nothing of the drawing is an arena; name a group.*line, room"),
        ('<rect id="ramp1" width="9" height="9"/>', {}, "ramp1: a ramp; remove it; the floor is a plane"),
        (
            '<rect id="room" width="9" height="9"/>',
            {"size": 'width="9" height="9"'},
            "no physical size; give --width-m",
        ),
        ("<g", {}, "cannot be read"),
        (
            '<polyline id="wall" points="{}"/>'.format(" ".join(f"{i},{i % 7}" for i in range(MAX_WALLS + 5))),
            {},
            r"walls: got \d+, allowed: at most 1000",
        ),
    ],
)
def test_a_drawing_that_is_no_arena_is_refused(body, options, message):
    with pytest.raises(InputError, match=message):
        svg(body, **options)


def test_entities_are_refused():
    with pytest.raises(InputError, match="without entities"):
        drawing_from_svg(b'<!DOCTYPE svg [<!ENTITY a "b">]><svg/>', "plan.svg", None)


def plan():
    image = np.full((300, 400, 3), 255, np.uint8)
    cv2.rectangle(image, (10, 10), (389, 289), (0, 0, 0), 9)
    cv2.rectangle(image, (180, 120), (219, 159), (0, 0, 0), -1)
    return cv2.imencode(".png", image)[1].tobytes()


def test_dark_areas_of_a_floor_plan_are_walls_to_a_pixel():
    drawing = drawing_from_image(plan(), "plan.png", 4.0)  # 1 cm per pixel
    (room,), (outer, pillar) = drawing.rooms, sorted(drawing.pillars, key=np.ptp, reverse=True)
    low, high = np.array(room).min(axis=0), np.array(room).max(axis=0)
    # The frame is 9 px wide about row and column 10; y is downwards in the image.
    assert low == pytest.approx((0.15, -2.85), abs=0.011)
    assert high == pytest.approx((3.85, -0.15), abs=0.011)
    assert np.array(pillar).min(axis=0) == pytest.approx((1.80, -1.60), abs=0.011)
    assert np.array(pillar).max(axis=0) == pytest.approx((2.20, -1.20), abs=0.011)
    assert len(pillar) == 4
    assert np.array(outer).min(axis=0) == pytest.approx((0.06, -2.94), abs=0.011)


@pytest.mark.parametrize(
    ("data", "width_m", "message"),
    [
        (plan(), None, "the width of the image is not known; add it in metres: --width-m 2.4"),
        (b"GIF89a", 4.0, "the image .*allowed: PNG or JPEG"),
        (cv2.imencode(".png", np.full((9, 9, 3), 255, np.uint8))[1].tobytes(), 4.0, "nothing in the image is darker"),
    ],
)
def test_an_image_that_is_no_floor_plan_is_refused(data, width_m, message):
    with pytest.raises(InputError, match=message):
        drawing_from_image(data, "plan.png", width_m)

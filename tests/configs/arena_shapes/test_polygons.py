"""Walls of polygons, and messages about floors that are no plane."""

import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario, load_section, section_of
from symolo.arena.geometry import Arena
from symolo.core.errors import InputError

SQUARE = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]


def walls(**polygon):
    arena = {"name": "mine", "line": {"pieces": []}, "polygons": [{"name": "room", **polygon}]}
    return section_of("arena", arena, "test").tree["walls"]


@pytest.mark.parametrize("points", [SQUARE, SQUARE[::-1]])
@pytest.mark.parametrize(("robot", "outwards"), [("inside", 1.0), ("outside", -1.0)])
def test_the_bodies_are_on_the_side_where_the_robot_is_not(points, robot, outwards):
    tree = {"name": "mine", "line": {"pieces": []}, "polygons": [{"name": "room", "points": points, "robot_is": robot}]}
    arena = draw_run(load_scenario("smoke", ["arena.walls=[]"]), "CW", 1).arena
    section = section_of("arena", tree, "test").tree
    boxes = Arena.from_config(arena.model_validate(section)).boxes
    assert [box.name for box in boxes] == ["room_1", "room_2", "room_3", "room_4"]
    for box in boxes:
        # Faces at 1 m from the middle, bodies of 20 mm behind them.
        assert max(abs(np.array(box.center[:2]))) == pytest.approx(1.0 + outwards * 0.01)
        assert box.size[:2] == pytest.approx((2.0, 0.02))


@pytest.mark.parametrize("robot", ["inside", "outside", "left"])
def test_a_polygon_that_crosses_itself_is_refused(robot):
    """It has no inside, and a robot is not to the left of all walls. The sides that cross are the diagonals."""
    bow_tie = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]]
    row = [[-1.0, -1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, 1.0]]
    with pytest.raises(InputError) as caught:
        walls(points=row if robot == "left" else bow_tie, robot_is=robot)
    sides = "1 and 3" if robot == "left" else "2 and 4"
    assert f"arena.polygons.0.points: the sides {sides} cross" in str(caught.value)
    assert "list the corners in their order around the polygon" in str(caught.value)


def test_a_polygon_may_have_a_bay_and_touch_itself():
    bay = [[-1, -1], [1, -1], [1, 1], [0.5, 1], [0.5, 0], [-0.5, 0], [-0.5, 1], [-1, 1]]
    assert len(walls(points=bay)) == 8
    keyhole = [[-1, -1], [1, -1], [1, 1], [0, 1], [0, 0], [0.2, 0], [0.2, -0.2], [0, -0.2], [0, 0], [0, 1], [-1, 1]]
    assert len(walls(points=keyhole)) == 11


def test_an_open_row_has_no_wall_from_its_end_to_its_start():
    row = walls(points=SQUARE[:3], robot_is="left", height_m=0.3, surface="wood")
    assert [(wall["start"], wall["end"]) for wall in row] == [(SQUARE[0], SQUARE[1]), (SQUARE[1], SQUARE[2])]
    assert {(wall["height_m"], wall["surface"]) for wall in row} == {(0.3, "wood")}


def test_walls_beside_polygons_stay_and_a_scale_holds_for_both(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(
        "name: mine\nline: {pieces: []}\nwalls: [{name: A, start: [0, 0], end: [1, 0]}]\n"
        "polygons: [{name: room, points: [[-1, -1], [2, -1], [2, 2]]}]\n"
    )
    tree = section_of("arena", {"extends": str(path), "scale": 0.5, "name": "half"}, "test").tree
    assert [wall["name"] for wall in tree["walls"]] == ["A", "room_1", "room_2", "room_3"]
    assert tree["walls"][0]["end"] == [0.5, 0.0]
    assert tree["walls"][1]["end"] == [1.0, -0.5]
    assert tree["walls"][1]["height_m"] == 0.075


@pytest.mark.parametrize(
    ("polygon", "message"),
    [
        ({"points": [[0, 0]]}, r"arena\.polygons\.0\.points: got .*at least 2 items"),
        ({"points": [[0, 0], [{"uniform": [1, 2]}, 0]]}, "no distribution is allowed here; write numbers"),
        ({"points": SQUARE, "robot_is": "above"}, "robot_is: got 'above', allowed: one of inside, outside, left"),
        ({"points": SQUARE, "height": 0.1}, "height: unknown key.*did you mean height_m"),
    ],
)
def test_a_polygon_that_is_none_is_refused(polygon, message):
    with pytest.raises(InputError, match=message):
        walls(**polygon)


def test_shipped_arenas_have_no_key_of_a_polygon():
    assert "polygons" not in load_section("arena", "symolo").tree
    assert '"polygons"' not in draw_run(load_scenario("symolo"), "CW", 1).model_dump_json()


@pytest.mark.parametrize("key", ["arena.ramps=[]", "arena.obstacles.0.pitch_deg=20", "arena.walls.0.slope=0.1"])
def test_a_ramp_is_refused_with_the_reason(key):
    with pytest.raises(InputError, match=r"the floor is a plane: ramps, steps .*robot\.effects\.floor_slope"):
        load_scenario("symolo", [key])

import numpy as np
import pybullet
import pytest
from hypothesis import given
from hypothesis import strategies as st

from configs.schema.arena import Obstacle, WallConfig
from physics.arena.surfaces import SURFACES
from physics.bullet.world import add_arena, connect
from symolo.arena.geometry import Arc, Arena, Line, Straight

SLANTED = Straight((1.0, 2.0), (4.0, 6.0))
LEFT_TURN = Arc((0.0, 0.0), 0.5, 0.0, np.pi / 2)
RIGHT_TURN = Arc((0.0, 0.0), 0.5, np.pi / 2, 0.0)
PIECES = [SLANTED, LEFT_TURN, RIGHT_TURN, Arc((0.2, -0.7), 0.35, np.radians(270), np.radians(360))]


def test_lengths():
    assert SLANTED.length_m == 5.0
    assert LEFT_TURN.length_m == RIGHT_TURN.length_m == pytest.approx(0.25 * np.pi)


def test_left_is_left_of_the_direction_of_travel():
    s, offset = SLANTED.local(np.array([[1.0, 2.0], [4.0, 6.0], [0.2, 2.6]]))
    assert s == pytest.approx([0.0, 5.0, 0.0])
    assert offset == pytest.approx([0.0, 0.0, 1.0])
    inside = np.array([[0.4, 0.0]])
    assert LEFT_TURN.local(inside)[1] == pytest.approx([0.1])
    assert RIGHT_TURN.local(inside)[1] == pytest.approx([-0.1])


@pytest.mark.parametrize("piece", PIECES)
@given(share=st.floats(0.0, 1.0), offset=st.floats(-0.1, 0.1))
def test_at_and_local_undo_each_other(piece, share, offset):
    s, found = piece.local(piece.at(np.array([share * piece.length_m]), offset))
    assert s == pytest.approx([share * piece.length_m], abs=1e-9)
    assert found == pytest.approx([offset], abs=1e-9)


def test_tape_covers_its_width_and_ends_square():
    line = Line((Straight((0.0, 0.0), (1.0, 0.0)),), width_m=0.015, reflectance=0.05)
    points = np.array([[0.5, 0.0074], [0.5, 0.0076], [0.0001, -0.0074], [-0.0001, 0.0], [1.0001, 0.0]])
    assert line.covers(points).tolist() == [True, False, True, False, False]


def test_edges_are_half_the_width_from_the_middle():
    line = Line((SLANTED, LEFT_TURN), width_m=0.02, reflectance=0.05)
    for piece, (left, right) in zip(line.pieces, line.edges(), strict=True):
        assert piece.local(left)[1] == pytest.approx(np.full(len(left), 0.01))
        assert piece.local(right)[1] == pytest.approx(np.full(len(right), -0.01))


def test_the_dataset_arena_is_that_of_the_specification(arena):
    line = arena.line
    # Two open runs of three pieces, each joined end to start or end to end.
    ends = [piece.at(np.array([0.0, piece.length_m])) for piece in line.pieces]
    assert ends[0] == pytest.approx(np.array([[0.55, -0.70], [0.55, 0.50]]))
    assert ends[1] == pytest.approx(np.array([[0.55, 0.50], [0.30, 0.75]]))
    assert ends[2][1] == pytest.approx([-0.20, 0.75])
    assert ends[3] == pytest.approx(np.array([[0.20, -1.05], [0.55, -0.70]]))
    assert ends[5] == pytest.approx(np.array([[-0.67, -0.75], [-0.37, -1.05]]))
    assert [box.name for box in arena.boxes] == ["A1", "A2", "B", "O1", "O2"]
    assert {box.size[2] for box in arena.boxes if box.kind == "wall"} == {0.15}
    assert {box.size for box in arena.boxes if box.kind == "obstacle"} == {(0.08, 0.08, 0.12)}


def test_the_robot_side_faces_of_the_walls_are_where_they_are_specified(arena):
    faces = {
        "A1": ((-0.05, 0.90), (-0.85, 0.90)),
        "A2": ((-0.85, 0.90), (-0.80, 0.15)),
        "B": ((-0.52, -0.72), (-0.49, 0.30)),
    }
    path = {"A1": (-0.4, 0.7), "A2": (-0.6, 0.5), "B": (-0.7, -0.2)}
    for box in arena.boxes[:3]:
        corners = box.footprint()
        start, end = np.array(faces[box.name])
        along = (end - start) / np.hypot(*(end - start))
        away = np.array([along[1], -along[0]])
        depth = np.sort((corners - start) @ away)
        assert depth == pytest.approx([0.0, 0.0, 0.02, 0.02], abs=1e-12)
        assert (np.array(path[box.name]) - start) @ away < 0.0


def test_an_obstacle_stands_on_the_floor_turned_by_its_yaw(arena_config):
    turned = Obstacle(name="turned", center=(1.0, 2.0), size=(0.2, 0.1, 0.3), yaw_deg=90.0)
    box = Arena.from_config(arena_config.model_copy(update={"walls": (), "obstacles": (turned,)})).boxes[0]
    assert box.center == pytest.approx((1.0, 2.0, 0.15))
    assert np.sort(box.footprint()[:, 0]) == pytest.approx([0.95, 0.95, 1.05, 1.05])
    assert np.sort(box.footprint()[:, 1]) == pytest.approx([1.9, 1.9, 2.1, 2.1])


def test_the_engine_has_the_arena_bodies_where_the_geometry_says(arena):
    client = connect(1000)
    surfaces = add_arena(client, arena)
    for body, surface in surfaces.items():
        if surface == 0:
            continue
        low, high = pybullet.getAABB(body, physicsClientId=client)
        box = arena.boxes[surface - 1]
        corners = box.footprint()
        assert np.abs(np.array(low[:2]) - corners.min(axis=0)).max() < 1e-3
        assert np.abs(np.array(high[:2]) - corners.max(axis=0)).max() < 1e-3
        assert high[2] == pytest.approx(box.size[2], abs=1e-3)
    pybullet.disconnect(client)
    assert sorted(surfaces.values()) == list(range(1 + len(arena.boxes)))


def test_every_surface_has_its_mean_and_spread_from_tables_3_and_4():
    measured = {
        "white_board": (100.25, 0.84),
        "light_grey_board": (100.21, 0.82),
        "dark_grey_board": (101.24, 0.79),
        "black_board": (95.63, 0.80),
        "metal": (89.06, 1.28),
        "wood": (99.88, 1.42),
        "glass": (96.58, 1.77),
        "paper": (101.42, 1.45),
        "plastic": (99.7, 1.31),
    }
    found = {name: (s.mean_mm_at_100_mm, s.sd_mm_at_100_mm) for name, s in SURFACES.items() if name in measured}
    assert found == measured
    assumed = {"cardboard": "paper", "plywood": "wood", "brick": "paper"}
    assert set(SURFACES) == set(measured) | set(assumed)
    assert all(SURFACES[name].offset_m == SURFACES[like].offset_m for name, like in assumed.items())
    assert SURFACES["metal"].offset_m == pytest.approx(-0.01094)


def test_a_wall_body_lies_to_the_right_of_start_to_end(arena_config):
    wall = WallConfig(name="w", start=(0.0, 0.0), end=(1.0, 0.0), thickness_m=0.1)
    box = Arena.from_config(arena_config.model_copy(update={"walls": (wall,), "obstacles": ()})).boxes[0]
    assert np.sort(box.footprint()[:, 1]) == pytest.approx([-0.1, -0.1, 0.0, 0.0])

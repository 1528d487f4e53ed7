"""Pieces of furniture and the bodies that they are made of."""

from dataclasses import is_dataclass
from itertools import pairwise

import numpy as np
import pytest

from blender_scenes.rooms.furniture import STANDING
from blender_scenes.rooms.furniture.bag import bag
from blender_scenes.rooms.furniture.book_stack import book_stack
from blender_scenes.rooms.furniture.bottle import bottle
from blender_scenes.rooms.furniture.cable import cable
from blender_scenes.rooms.furniture.carton import carton
from blender_scenes.rooms.furniture.chair import chair
from blender_scenes.rooms.furniture.door import door, drawn_door
from blender_scenes.rooms.furniture.office_chair import office_chair
from blender_scenes.rooms.furniture.poster import drawn_poster, poster
from blender_scenes.rooms.furniture.radiator import drawn_radiator, radiator
from blender_scenes.rooms.furniture.sheets import sheets
from blender_scenes.rooms.furniture.shelf import shelf
from blender_scenes.rooms.furniture.table import WorkTable, table
from blender_scenes.rooms.furniture.wall_socket import drawn_wall_socket, wall_socket
from blender_scenes.rooms.furniture.waste_bin import waste_bin
from blender_scenes.scene.solids import cushion, joined, lathe, pipe, posed, rod, stood
from configs.schema.appearance.paint import Paint
from symolo.core.random_streams import stream

HANGING = {
    "door": drawn_door,
    "poster": drawn_poster,
    "radiator": lambda name, rng: drawn_radiator(name, rng, window_m=2.0, sill_m=0.8),
    "wall_socket": drawn_wall_socket,
}
SIZES = {  # width, depth and height that such things have in shops [m]
    "table": ((0.6, 2.0), (0.4, 1.0), (0.68, 0.80)),
    "chair": ((0.35, 0.55), (0.35, 0.6), (0.7, 0.95)),
    "office_chair": ((0.5, 0.75), (0.5, 0.75), (0.9, 1.25)),
    "shelf": ((0.5, 1.2), (0.2, 0.5), (0.8, 2.2)),
    "carton": ((0.15, 0.6), (0.1, 0.5), (0.1, 0.5)),
    "waste_bin": ((0.18, 0.45), (0.18, 0.45), (0.2, 0.5)),
    "bag": ((0.2, 0.45), (0.15, 0.45), (0.3, 0.55)),
    "cable": ((0.05, 0.8), (0.7, 2.0), (0.03, 0.06)),
    "book_stack": ((0.13, 0.4), (0.18, 0.4), (0.01, 0.25)),
    "bottle": ((0.05, 0.1), (0.05, 0.1), (0.15, 0.35)),
    "sheets": ((0.2, 0.6), (0.2, 0.6), (0.0002, 0.003)),
}


def _volume(mesh) -> float:
    """By the divergence theorem, each face as a fan of triangles; positive where the faces look outwards."""
    points = np.array(mesh.vertices)
    fans = [(face[0], b, c) for face in mesh.faces for b, c in pairwise(face[1:])]
    a, b, c = points[np.array(fans)].transpose(1, 0, 2)
    return float(np.sum(a * np.cross(b, c))) / 6


def _prism(radius: float, sides: int) -> float:
    """Area of a regular polygon."""
    return 0.5 * sides * radius**2 * np.sin(2 * np.pi / sides)


def test_a_turned_body_is_the_prism_of_its_sides():
    assert _volume(lathe("can", [(0.1, 0.0), (0.1, 0.3)], "s", sides=24)) == pytest.approx(0.3 * _prism(0.1, 24))


def test_a_cup_holds_its_wall_alone():
    cup = lathe("cup", [(0.1, 0.0), (0.1, 0.3), (0.09, 0.3), (0.09, 0.01)], "s", sides=24)
    assert _volume(cup) == pytest.approx(0.3 * _prism(0.1, 24) - 0.29 * _prism(0.09, 24))


def test_a_cone_between_any_two_points():
    """A third of the height times both areas and their geometric mean."""
    ends = (0.1, 0.2, 0.3), (-0.2, 0.6, 0.1)
    big, small, length = _prism(0.05, 12), _prism(0.02, 12), float(np.linalg.norm(np.subtract(*ends)))
    assert _volume(rod("leg", ends, (0.05, 0.02), "s")) == pytest.approx(
        length / 3 * (big + small + np.sqrt(big * small))
    )


def test_a_straight_cable_is_a_prism_and_a_cushion_of_2_nearly_an_ellipsoid():
    path = [(0.0, 0.1 * i, 0.01) for i in range(8)]
    assert _volume(pipe("cable", path, 0.004, "s", sides=8)) == pytest.approx(0.7 * _prism(0.004, 8))
    ball = _volume(cushion("ball", (1, 2, 3), (0.4, 0.3, 0.2), "s", squareness=2.0))
    assert ball == pytest.approx(np.pi / 6 * 0.4 * 0.3 * 0.2, rel=0.06)


def test_turning_and_standing_keep_the_shape():
    leg = rod("leg", ((0, 0, 0), (0, 0, 1)), (0.05, 0.02), "s")
    tilted = posed(leg, np.array([[0, 0, 1.0], [1, 0, 0], [0, 1, 0]]), (1, 2, 3))
    there = stood(tilted, (0.5, -0.5, 1.2))
    assert _volume(tilted) == pytest.approx(_volume(leg))
    assert _volume(there) == pytest.approx(_volume(leg))
    assert np.array(tilted.vertices)[:, 0].max() == pytest.approx(2.0)  # z has become x
    assert _volume(joined("two", [leg, there])) == pytest.approx(2 * _volume(leg))


def test_a_table_is_as_large_as_its_numbers_say():
    paint = Paint(reflectance=0.5)
    piece = table("table_7", WorkTable((1.4, 0.7, 0.74), 0.05, 0.03, paint, paint, 0.4))
    assert piece.size_m == pytest.approx((1.4, 0.7))
    assert piece.height_m == pytest.approx((0.0, 0.74))
    assert piece.top_m == 0.74
    assert piece.mesh.name == "table_7"


MAKERS = (
    bag, book_stack, bottle, cable, carton, chair, door, office_chair, poster, radiator, sheets, shelf, table,
    wall_socket, waste_bin,
)  # fmt: skip


@pytest.mark.parametrize("make", MAKERS, ids=lambda make: make.__name__)
def test_the_numbers_of_a_piece_are_enough_to_make_it_again(make):
    draw = {kind.name: kind.draw for kind in STANDING.values()} | HANGING
    piece = draw[make.__name__]("it", stream(3, make.__name__))
    assert is_dataclass(piece.numbers)
    assert make("it", piece.numbers) == piece


@pytest.mark.parametrize("kind", STANDING.values(), ids=lambda kind: kind.name)
def test_every_piece_stands_on_the_floor_and_has_a_plausible_size(kind):
    for number in range(8):
        piece = kind.draw("it", stream(3, kind.name, number))
        low, high = piece.height_m
        assert -1e-9 <= low < 0.005
        for extent, (least, most) in zip((*piece.size_m, high), SIZES[kind.name], strict=True):
            assert least <= extent <= most
        _whole(piece)


@pytest.mark.parametrize("name", HANGING)
def test_every_piece_on_a_wall_comes_out_of_it_by_a_little(name):
    for number in range(6):
        piece = HANGING[name]("it", stream(3, name, number))
        depth = np.array(piece.mesh.vertices)[:, 1]
        assert depth.max() <= 1e-9
        assert 0.0005 <= -depth.min() <= 0.13
        _whole(piece)


def _whole(piece) -> None:
    """Every face has a surface that the piece brings, and its volume lies inside."""
    assert set(piece.mesh.face_surface) == {surface.name for surface in piece.surfaces}
    assert all(surface.name.startswith("it_") for surface in piece.surfaces)
    assert _volume(piece.mesh) > 0


def test_a_bin_is_open_and_thin():
    piece = STANDING["bins"].draw("it", stream(3, "bin"))
    low, high = piece.height_m
    assert _volume(piece.mesh) < 0.2 * (high - low) * _prism(0.5 * piece.size_m[0], 20)

"""Where furniture stands, over many seeds."""

from functools import cache
from itertools import combinations

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from blender_scenes.rooms.furniture import STANDING
from blender_scenes.rooms.plain import plain_room
from configs.schema.appearance.look import LookConfig
from configs.schema.appearance.room import FurnitureLook, RoomLook, WindowLook
from symolo.arena.footprints import Rectangle, outlines_overlap

LOW, HIGH = (-0.8, -1.1), (0.6, 0.9)
CROWDED = FurnitureLook(
    clearance_m=0.5, tables=4, chairs=5, office_chairs=2, shelves=3, cartons=5, bags=3, bins=2, book_stacks=3,
    bottles=3, sheets=3, cables=3, posters=6, sockets=6, door=True, radiator=True,
)  # fmt: skip
KINDS = {kind.name for kind in STANDING.values()}


@cache
def _room(seed: int, furniture: FurnitureLook = CROWDED, **room):
    side = ("east", "north", "west", "south")[seed % 4]
    look = LookConfig(name="full", room=RoomLook(furniture=furniture, **room), window=WindowLook(side=side))
    return plain_room(look, LOW, HIGH, seed)


def _pieces(room) -> dict[str, np.ndarray]:
    """(N, 3) vertices of what the furniture added, by name."""
    own = {*KINDS, "poster", "socket", "door", "radiator"}
    return {m.name: np.array(m.vertices) for m in room.meshes if m.name.rstrip("0123456789").rstrip("_") in own}


def _kind(name: str) -> str:
    return name.rstrip("0123456789").rstrip("_")


def _outline(vertices: np.ndarray):
    return vertices[ConvexHull(vertices[:, :2]).vertices, :2].tolist()


@pytest.mark.parametrize("seed", range(6))
def test_nothing_stands_in_the_robots_way_outside_the_room_or_in_another_piece(seed):
    room = _room(seed)
    pieces = _pieces(room)
    middle, size = (0.5 * np.add(LOW, HIGH)), np.subtract(HIGH, LOW) + 2 * CROWDED.clearance_m
    free = Rectangle((float(middle[0]), float(middle[1])), (float(size[0]), float(size[1])), 0.0).corners()
    outlines = {name: _outline(vertices) for name, vertices in pieces.items()}
    for name, vertices in pieces.items():
        assert np.all(vertices[:, :2] >= np.array(room.low) - 1e-9), name
        assert np.all(vertices[:, :2] <= np.array(room.high) + 1e-9), name
        assert -1e-9 <= vertices[:, 2].min() < vertices[:, 2].max() <= room.height_m
        assert not outlines_overlap(outlines[name], free), name
    for one, other in combinations(outlines, 2):
        if _kind(one) in KINDS or _kind(other) in KINDS:
            assert not outlines_overlap(outlines[one], outlines[other]), (one, other)


@pytest.mark.parametrize("seed", range(6))
def test_what_hangs_on_the_walls_neither_overlaps_nor_covers_the_window(seed):
    room = _room(seed)
    boxes = {n: (v.min(axis=0), v.max(axis=0)) for n, v in _pieces(room).items() if _kind(n) not in KINDS}
    window = room.window
    half = 0.5 * (window.width_m * np.abs(window.right) + window.height_m * np.array(window.up))
    boxes["window"] = (
        np.array(window.center) - half - 0.2 * np.abs(window.inward),
        window.center + half + 0.2 * np.abs(window.inward),
    )
    for (one, (a, b)), (other, (c, d)) in combinations(boxes.items(), 2):
        assert np.any((b <= c + 1e-9) | (d <= a + 1e-9)), (one, other)


def test_a_large_room_takes_every_piece_that_is_asked_for():
    wide = dict.fromkeys(("margin_east_m", "margin_north_m", "margin_west_m", "margin_south_m"), 6.0)
    room = _room(5, **wide)
    names = [_kind(name) for name in _pieces(room)]
    counts = {kind.name: getattr(CROWDED, field) for field, kind in STANDING.items()}
    assert {name: names.count(name) for name in counts} == counts
    assert (names.count("poster"), names.count("socket")) == (6, 6)
    assert names.count("door") == names.count("radiator") == 1
    assert len(room.tops) == CROWDED.tables


def test_a_bare_room_is_bare_and_the_same_whatever_the_seed():
    bare = _room(4, FurnitureLook())
    assert not _pieces(bare)
    assert bare.meshes == _room(8, FurnitureLook()).meshes


def test_the_same_seed_gives_the_same_room_and_another_one_another():
    assert _room(3).meshes == _room.__wrapped__(3).meshes
    first, second = _pieces(_room(1)), _pieces(_room(5))
    assert not np.array_equal(first["table_0"], second["table_0"])


def test_another_bottle_leaves_all_that_found_its_place_before_as_it_was():
    more = CROWDED.model_copy(update={"bottles": 5, "posters": 9})
    before, after = _pieces(_room(3)), _pieces(_room(3, more))
    kept = {name for name in before if _kind(name) != "sheets"}
    assert len(after) > len(before)
    for name in kept:
        np.testing.assert_array_equal(before[name], after[name])


def test_a_low_sill_leaves_no_room_for_a_radiator():
    look = LookConfig(name="low", room=RoomLook(furniture=CROWDED), window=WindowLook(sill_m=0.1))
    assert "radiator" not in {mesh.name for mesh in plain_room(look, LOW, HIGH, 1).meshes}

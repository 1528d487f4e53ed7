"""Shares of texels below bodies, by areas in closed form."""

from dataclasses import replace

import numpy as np
import pytest

from blender_scenes.hybrid.floor.footprints import Footprints
from blender_scenes.hybrid.floor.tiled_map import Tile
from blender_scenes.rooms.furniture.sheets import Sheets, sheets
from blender_scenes.scene.bevel import bevelled_box
from blender_scenes.scene.description import Mesh
from blender_scenes.scene.meshes import block, rectangle, wheel
from blender_scenes.scene.solids import stood
from configs.schema.appearance.paint import Paint

TEXEL_M, SIDE = 0.008, 24
TILE = Tile((-0.05, 0.02), TEXEL_M, SIDE, (0, 0, 0))
SMALL = block("box", (0.03, 0.11, 0.05), (0.05, 0.06, 0.1), "any")


def _covered(*meshes: Mesh, tile: Tile = TILE) -> np.ndarray:
    return Footprints(meshes).covered(tile)[..., 0]


def _share(low_m: float, high_m: float, tile_low_m: float) -> np.ndarray:
    """(N,) how much of each texel along an axis lies between two places."""
    at = tile_low_m + TEXEL_M * np.arange(SIDE)
    return np.clip(np.minimum(high_m, at + TEXEL_M) - np.maximum(low_m, at), 0, None) / TEXEL_M


def test_an_upright_box_covers_the_shares_of_its_sides():
    x, y = _share(0.005, 0.055, TILE.low[0]), _share(0.08, 0.14, TILE.low[1])
    np.testing.assert_allclose(_covered(SMALL), y[:, None] * x, atol=1e-6)


def test_sheets_of_paper_cover_the_floor_below_each_of_them():
    """No light reaches the floor there, so that its map would be dark around the edges of the paper.

    Three sheets of A4 lie side by side, each on the border of the one before; a strip of 10 mm is below two.
    """
    paper = Paint(reflectance=0.7, hue_deg=50, saturation=0.1)
    piece = sheets("papers", Sheets(((-0.2, 0.0, 0.0), (0.0, 0.0, 0.0), (0.2, 0.0, 0.0)), paper))
    tile = replace(TILE, low=(-0.4, -0.4), texels=100)
    area_m2 = _covered(piece.mesh, tile=tile).sum() * TEXEL_M**2
    assert area_m2 == pytest.approx((3 * 0.210 - 2 * 0.010) * 0.297, rel=5e-3)


def test_a_box_with_bevels_that_is_open_below_covers_the_same():
    corners = np.array(SMALL.vertices)
    bevelled = bevelled_box("box", corners, ("any",) * 4, "any")
    whole, open_below = _covered(SMALL), _covered(bevelled)
    inner = whole == 1
    assert inner.sum() >= 20
    np.testing.assert_allclose(open_below[inner], 1, atol=1e-6)
    # Its upright edges are cut off: four triangles, 0.8 mm high and wide.
    assert whole.sum() - open_below.sum() == pytest.approx(4 * 0.5 * 0.0008**2 / TEXEL_M**2, rel=0.25)


@pytest.mark.parametrize("yaw", [0.3, 1.1, 2.5])
def test_a_turned_box_covers_its_area(yaw):
    turned = stood(block("box", (0.0, 0.0, 0.05), (0.05, 0.06, 0.1), "any"), (0.03, 0.11, yaw))
    covered = _covered(turned)
    assert covered.sum() * TEXEL_M**2 == pytest.approx(0.05 * 0.06, rel=2e-3)
    y, x = (np.indices(covered.shape) + 0.5) * TEXEL_M
    assert (covered * (x + TILE.low[0])).sum() / covered.sum() == pytest.approx(0.03, abs=1e-4)
    assert (covered * (y + TILE.low[1])).sum() / covered.sum() == pytest.approx(0.11, abs=1e-4)


def test_a_body_that_reaches_beyond_the_tile_covers_its_part():
    wall = block("wall", (0.0, 0.11, 0.1), (4.0, 0.06, 0.2), "any")
    expected = np.broadcast_to(_share(0.08, 0.14, TILE.low[1])[:, None], (SIDE, SIDE))
    np.testing.assert_allclose(_covered(wall), expected, atol=1e-6)
    away = block("wall", (9.0, 0.11, 0.1), (4.0, 0.06, 0.2), "any")
    assert not _covered(away, block("wall", (-9.0, 0.11, 0.1), (4.0, 0.06, 0.2), "any")).any()


def test_bodies_beside_each_other_cover_their_sum():
    skirting = block("skirting", (0.03, 0.147, 0.05), (0.05, 0.014, 0.1), "any")
    np.testing.assert_allclose(
        _covered(SMALL, skirting), np.minimum(_covered(SMALL) + _covered(skirting), 1), atol=1e-6
    )


def test_neither_what_hangs_nor_a_single_face_nor_a_room_seen_from_inside_covers_the_floor():
    hanging = block("shelf", (0.03, 0.11, 0.5), (0.05, 0.06, 0.1), "any")
    pane = rectangle("pane", [(-1.0, 0.1, 0.0), (1.0, 0.1, 0.0), (1.0, 0.1, 1.0), (-1.0, 0.1, 1.0)], "any")
    room = replace(SMALL, faces=tuple(face[::-1] for face in SMALL.faces))
    assert not _covered(hanging, pane, room).any()
    assert not _covered().any()


def test_a_wheel_covers_the_strip_that_its_cut_is_wide():
    """A circle of 30 mm has a chord of 2 sqrt(2 r h) at a height h of 0.5 mm, to first order."""
    standing = wheel("wheel", (0.03, 0.11, 0.03), 0.03, 0.016, "any")
    chord_m = 2 * np.sqrt(2 * 0.03 * 0.0005)
    assert _covered(standing).sum() * TEXEL_M**2 == pytest.approx(0.016 * chord_m, rel=0.2)


def test_neighbouring_tiles_have_the_texels_of_a_larger_one():
    turned = stood(SMALL, (0.02, 0.01, 0.4))
    half = SIDE // 2
    right = Tile((TILE.low[0] + half * TEXEL_M, TILE.low[1]), TEXEL_M, half, (0, 1, 0))
    np.testing.assert_allclose(_covered(turned, tile=right), _covered(turned)[:half, half:], atol=1e-5)

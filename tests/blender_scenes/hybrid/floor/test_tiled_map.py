"""Maps of a plane that are made tile by tile, against the functions that they are maps of."""

from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blender_scenes.hybrid.floor.tiled_map import Tile, TiledMap, Tiling, normals

TEXEL_M = 0.01
PLAIN = Tiling(texel_m=TEXEL_M, levels=3, core=16)
WITH_MARGIN = Tiling(texel_m=TEXEL_M, levels=3, core=12, margin=2)
TILINGS = [PLAIN, WITH_MARGIN]
MUCH = 2**30


def _middles(tile: Tile) -> tuple[np.ndarray, np.ndarray]:
    """(N, N) x and y of the middle of each texel [m]."""
    y, x = (np.indices((tile.texels, tile.texels)) + 0.5) * tile.texel_m
    return x + tile.low[0], y + tile.low[1]


def _planes(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Two of them, which bilinear interpolation leaves as they are."""
    return np.stack([1 + 0.5 * x - 0.25 * y, 2 * y], axis=-1)


def _linear(tile: Tile) -> np.ndarray:
    return _planes(*_middles(tile)).astype(np.float32)


def _rough(tile: Tile) -> np.ndarray:
    """Other numbers in every texel, by its place and level alone."""
    column, row = (np.rint(place / tile.texel_m - 0.5) for place in _middles(tile))
    wave = np.sin(12.9898 * column + 78.233 * row + 3.7 * tile.key[0]) * 43758.5453
    return (wave - np.floor(wave))[..., None].astype(np.float32)


def _grid(low: tuple[float, float], high: tuple[float, float], count: int = 40) -> np.ndarray:
    """(count, count, 2)."""
    x, y = np.meshgrid(np.linspace(low[0], high[0], count), np.linspace(low[1], high[1], count))
    return np.stack([x, y], axis=-1)


def _along(low: tuple[float, float], high: tuple[float, float]) -> np.ndarray:
    """(1, N, 2) places on the way, beside which tiles are not asked for."""
    return np.linspace(low, high, 300)[None]


def _looked_up(of: TiledMap, level: int, points: np.ndarray) -> np.ndarray:
    return of.patch(level, points).at(points)


@pytest.mark.parametrize("tiling", TILINGS)
@pytest.mark.parametrize("level", [0, 1, 2])
def test_a_plane_is_met_at_every_level_over_the_borders_of_tiles_and_where_coordinates_are_negative(tiling, level):
    points = _grid((-0.45, -0.61), (0.38, 0.27))
    found = _looked_up(TiledMap(tiling, _linear, MUCH), level, points)
    # Half precision below 2, and OpenCV's places, which are whole 32nds of a texel.
    off = 2**-11 * 2 + np.array([0.75, 2.0]) * TEXEL_M * 2**level / 64
    assert (np.abs(found - _planes(points[..., 0], points[..., 1])) <= off).all()


def test_the_texels_of_a_level_are_twice_those_of_the_one_before():
    seen = []
    own = TiledMap(PLAIN, lambda tile: seen.append(tile) or _linear(tile), MUCH)
    for level in range(3):
        own.patch(level, np.array([[0.05, 0.05]]))
    here = [tile for tile in seen if tile.key[1:] == (0, 0)]
    assert [tile.texel_m for tile in here] == pytest.approx([TEXEL_M, 2 * TEXEL_M, 4 * TEXEL_M])
    assert {tile.texels for tile in here} == {16}


@pytest.mark.parametrize("core", [4, 8, 13])
@pytest.mark.parametrize("margin", [0, 1, 2])
def test_what_tiles_count_for_is_1_in_all(core, margin):
    tiling, total = Tiling(1.0, 1, core, margin), np.zeros(5 * core + 2 * margin)
    shares = tiling.shares()
    assert len(shares) == tiling.side()
    for number in range(5):
        total[number * core : number * core + tiling.side()] += shares
    np.testing.assert_allclose(total[2 * margin : 5 * core], 1.0, rtol=1e-6)
    assert shares.min() > 0


def test_two_tiles_that_differ_pass_into_each_other_over_the_margin():
    """As two tiles of light do, traced with other random numbers: no seam."""
    tiling = Tiling(TEXEL_M, 1, 12, 2)
    own = TiledMap(tiling, lambda tile: np.full((tile.texels, tile.texels, 2), tile.key[1] % 2, np.float32), MUCH)
    x = (np.arange(25) + 0.5) * TEXEL_M  # middles of texels, the border of the tiles after twelve of them
    points = np.stack([x, np.full_like(x, 0.05)], axis=-1)[None]
    found = _looked_up(own, 0, points)[0, :, 0]
    np.testing.assert_allclose(found[2:10], 0.0)
    np.testing.assert_allclose(found[10:14], [0.125, 0.375, 0.625, 0.875], atol=1e-3)
    np.testing.assert_allclose(found[14:22], 1.0)


# Whatever was looked at before


def _wanderings() -> Iterator[np.ndarray]:
    """Places to look at: near and far, in steps, and all at once; some hold what `HERE` does, some a part of it."""
    for shift in (0.3, 0.11, 0.04):
        yield _grid((-0.2 - shift, -0.2), (0.2 + shift, 0.2), 60)
    yield _grid((-1.7, -1.3), (-1.2, -0.9))
    yield _grid((-0.05, -0.05), (0.6, 0.5))
    yield _grid((-0.9, -0.4), (0.0, 0.03))
    yield _along((-1.0, -0.9), (0.15, 0.19))
    yield _grid((-2.0, -2.0), (2.0, 2.0), 200)


HERE = _grid((-0.203, -0.211), (0.197, 0.189), 57)


@pytest.mark.parametrize("tiling", TILINGS)
@pytest.mark.parametrize("max_bytes", [MUCH, 1])
@pytest.mark.parametrize("precision", [np.float64, np.float32])
def test_a_point_has_the_same_value_whatever_was_looked_at_before(tiling, max_bytes, precision):
    """To the bit: another process renders the same image first. With one byte, no tile outlives the next."""
    here = HERE.astype(precision)
    expected = _looked_up(TiledMap(tiling, _rough, MUCH), 0, here)
    for before in _wanderings():
        own = TiledMap(tiling, _rough, max_bytes)
        own.patch(0, before.astype(precision))
        own.patch(1, before.astype(precision))
        np.testing.assert_array_equal(_looked_up(own, 0, here), expected)


def test_on_a_way_each_patch_takes_over_what_it_has_in_common_with_the_last():
    """Of tiles that are not kept, none is made twice for it."""
    made = []
    own = TiledMap(PLAIN, lambda tile: made.append(tile.key) or _rough(tile), 1)
    for begin in np.arange(-1.0, 1.0, 0.07):
        here = _along((begin, begin), (begin + 0.4, begin + 0.3))
        np.testing.assert_array_equal(_looked_up(own, 0, here), _looked_up(TiledMap(PLAIN, _rough, MUCH), 0, here))
    assert len(made) < 1.2 * len(set(made))


@pytest.mark.parametrize("tiling", TILINGS)
@pytest.mark.parametrize("precision", [np.float64, np.float32])
def test_nor_does_it_matter_how_far_the_tiles_reach_that_were_looked_at_before(tiling, precision):
    """Single precision has no more than three digits for a place within a texel some ten metres from the first one."""
    rng = np.random.default_rng(3)
    here = np.stack([rng.uniform(3.0, 3.5, (50, 400)), rng.uniform(-0.05, 0.05, (50, 400))], axis=-1).astype(precision)
    way = np.stack([np.linspace(-30.0, 3.5, 1200), np.zeros(1200)], axis=-1)
    own = TiledMap(tiling, _rough, MUCH)
    own.patch(0, np.concatenate([way, here.reshape(-1, 2)]))
    np.testing.assert_array_equal(_looked_up(own, 0, here), _looked_up(TiledMap(tiling, _rough, MUCH), 0, here))


def test_tiles_that_are_kept_are_not_made_again_and_those_beyond_the_bytes_are():
    made = []
    tile_bytes = 16 * 16 * 2
    places = [np.array([[0.08 + 0.16 * i, 0.08]]) for i in (0, 1, 2, 3)]  # each amid a tile of its own

    def make(tile: Tile) -> np.ndarray:
        made.append(tile.key)
        return _rough(tile)

    own = TiledMap(PLAIN, make, 3 * tile_bytes)
    for number in (0, 1, 2, 0, 1, 2, 3, 2, 0):
        own.patch(0, places[number])
    # The fourth tile takes the place of that which was longest not looked at, the first.
    assert [key[1] for key in made] == [0, 1, 2, 3, 0]


def test_the_same_view_again_makes_no_new_tiles():
    made = []
    own = TiledMap(WITH_MARGIN, lambda tile: made.append(tile.key) or _rough(tile), 1)
    first = own.patch(0, HERE)
    count = len(made)
    assert count == len(set(made)) > 4
    assert own.patch(0, HERE[10:20]) is first
    assert len(made) == count


# Holes


@given(
    tiling=st.sampled_from(TILINGS),
    level=st.integers(0, 2),
    places=st.lists(st.tuples(st.floats(-3, 3), st.floats(-3, 3)), min_size=1, max_size=12),
)
def test_every_requested_point_has_a_value(tiling, level, places):
    points = np.array(places)[None]
    found = _looked_up(TiledMap(tiling, _rough, MUCH), level, points)
    assert np.isfinite(found).all()
    assert found.min() >= 0
    assert found.max() <= 1


def test_where_no_tile_was_requested_the_value_is_nan_and_not_the_nearest_colour():
    """Which would depend on what was looked at before, and be wrong."""
    patch = TiledMap(PLAIN, lambda tile: _rough(tile).repeat(6, axis=-1), MUCH).patch(0, np.array([[0.05, 0.05]]))
    beyond = np.array([[[0.5, 0.05], [0.05, -0.5], [0.05, 0.05]]])
    assert np.isnan(patch.at(beyond)[0, :2]).all()
    assert np.isfinite(patch.at(beyond)[0, 2]).all()


# Relief


def test_a_slope_has_the_normal_of_its_plane():
    y, x = np.indices((9, 9)) * TEXEL_M
    found = normals((0.3 * x - 0.1 * y).astype(np.float32), np.zeros((9, 9), np.float32), TEXEL_M)
    expected = np.array([-0.3, 0.1, 1.0]) / np.sqrt(0.3**2 + 0.1**2 + 1)
    assert found.shape == (7, 7, 3)
    np.testing.assert_allclose(found, np.broadcast_to(expected, found.shape), atol=1e-4)


def test_where_two_surfaces_meet_the_step_between_their_heights_is_none():
    """Each has its height from a zero of its own."""
    height, whose = np.zeros((9, 9), np.float32), np.zeros((9, 9), np.float32)
    height[:, 4:], whose[:, 4:] = 0.005, 1.0
    np.testing.assert_array_equal(normals(height, whose, TEXEL_M), np.broadcast_to((0.0, 0.0, 1.0), (7, 7, 3)))
    one = normals(height, np.zeros((9, 9), np.float32), TEXEL_M)
    assert (one[:, 2:4, 0] < -0.2).all()


def test_a_tile_with_a_texel_more_on_each_side_has_the_others_where_they_were():
    tile = Tile((0.3, -0.2), TEXEL_M, 4, (1, 5, -3))
    x, y = _middles(tile)
    wide_x, wide_y = _middles(tile.widened())
    np.testing.assert_allclose(wide_x[1:-1, 1:-1], x, atol=1e-12)
    np.testing.assert_allclose(wide_y[1:-1, 1:-1], y, atol=1e-12)
    assert (tile.widened().texels, tile.widened().key) == (6, tile.key)

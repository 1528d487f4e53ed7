"""Texels that an edge of the line or of a sheet crosses, by areas in closed form."""

import numpy as np
import pytest

from blender_scenes.hybrid.floor.layers import FloorLayers
from blender_scenes.hybrid.floor.tiled_map import Tile
from blender_scenes.scene.description import Mesh
from blender_scenes.scene.meshes import rectangle

TEXEL_M, SIDE = 0.004, 12
FLOOR, SHEET, TAPE = 0.5, 0.9, 0.1
SAMPLE = np.array([FLOOR, SHEET, TAPE], np.float32)
"""Value of each surface by its number."""
FAR_M = 1.0


def _box(name: str, low: tuple[float, float], high: tuple[float, float], z: float) -> Mesh:
    return rectangle(
        name, [(low[0], low[1], z), (high[0], low[1], z), (high[0], high[1], z), (low[0], high[1], z)], name
    )


def _floor(*sheets: Mesh) -> Mesh:
    ground = _box("floor", (-FAR_M, -FAR_M), (FAR_M, FAR_M), 0.0)
    vertices, faces, surfaces = list(ground.vertices), list(ground.faces), list(ground.face_surface)
    for sheet in sheets:
        faces += [tuple(len(vertices) + i for i in face) for face in sheet.faces]
        vertices += sheet.vertices
        surfaces += sheet.face_surface
    return Mesh("floor", tuple(vertices), tuple(faces), ground.uv_m * len(faces), tuple(surfaces))


def _shares(low_m: float, high_m: float, count: int = SIDE) -> np.ndarray:
    """(N,) how much of each texel along an axis, from 0, lies between two places."""
    at = TEXEL_M * np.arange(count)
    return np.clip(np.minimum(high_m, at + TEXEL_M) - np.maximum(low_m, at), 0, None) / TEXEL_M


def _sampled(low: tuple[float, float], high: tuple[float, float]) -> np.ndarray:
    """(N+2, N+2) whether the middles of the texels of the widened tile lie in a box."""
    at = TEXEL_M * (np.arange(SIDE + 2) - 0.5)
    inside = [(low[axis] < at) & (at < high[axis]) for axis in (0, 1)]
    return inside[1][:, None] & inside[0]


TILE = Tile((0.0, 0.0), TEXEL_M, SIDE, (0, 0, 0))
SHEET_BOX = (-FAR_M, 0.0182), (FAR_M, FAR_M)
TAPE_BOX = (0.0131, -FAR_M), (0.0294, FAR_M)


def _blended(meshes: list[Mesh], numbers: np.ndarray, tile: Tile = TILE, turn_rad: float = 0.0) -> np.ndarray:
    return FloorLayers(meshes, turn_rad).blended(tile, SAMPLE[numbers][..., None], numbers)[..., 0]


def test_texels_mix_the_colours_of_floor_sheet_and_tape_by_their_areas():
    """The tape lies upon the sheet, whose edge it crosses at a right angle."""
    meshes = [_floor(_box("sheet", *SHEET_BOX, 1e-5)), _box("tape_0", *TAPE_BOX, 1e-4)]
    numbers = np.where(_sampled(*TAPE_BOX), 2, np.where(_sampled(*SHEET_BOX), 1, 0))
    sheet, tape = _shares(SHEET_BOX[0][1], 1.0)[:, None], _shares(TAPE_BOX[0][0], TAPE_BOX[1][0])
    expected = tape * TAPE + (1 - tape) * (sheet * SHEET + (1 - sheet) * FLOOR)
    # Areas are exact along x, and eighths of texels along y.
    np.testing.assert_allclose(_blended(meshes, numbers), expected, atol=0.07 * (SHEET - FLOOR))


def test_a_gap_between_tapes_that_no_sample_meets_is_as_bright_as_its_share():
    gap = 0.0165, 0.0175
    """Between the middles of two texels, at 14 and 18 mm."""
    tapes = [
        _box("tape_0", (-FAR_M, 0.008), (gap[0], FAR_M), 1e-4),
        _box("tape_1", (gap[1], 0.008), (FAR_M, FAR_M), 1e-4),
    ]
    numbers = np.where(_sampled((-FAR_M, 0.008), (FAR_M, FAR_M)), 1, 0)
    share = _shares(*gap)
    mixed = FloorLayers([_floor(), *tapes], 0.0).blended(TILE, SAMPLE[[0, 2]][numbers][..., None], numbers)[..., 0]
    np.testing.assert_allclose(mixed[3:], np.broadcast_to(TAPE + share * (FLOOR - TAPE), mixed[3:].shape), atol=1e-5)


@pytest.mark.parametrize("turn_rad", [0.35, -1.2])
def test_turned_tiles_hold_the_area_of_a_tape(turn_rad):
    """A square of tape in the middle of the tile, sampled there."""
    half_m, middle_m = 0.0121, 0.5 * TEXEL_M * SIDE
    at = TEXEL_M * (np.arange(SIDE + 2) - 0.5)
    x, y = np.meshgrid(at, at)
    cosine, sine = np.cos(turn_rad), np.sin(turn_rad)
    X, Y = cosine * x - sine * y, sine * x + cosine * y
    center = np.array([cosine - sine, sine + cosine]) * middle_m
    inside = np.maximum(np.abs(X - center[0]), np.abs(Y - center[1])) < half_m
    square = _box("tape_0", tuple((center - half_m).tolist()), tuple((center + half_m).tolist()), 1e-4)
    numbers = inside.astype(int)
    mixed = FloorLayers([_floor(), square], turn_rad).blended(TILE, (1.0 * inside)[..., None], numbers)[..., 0]
    assert mixed.sum() * TEXEL_M**2 == pytest.approx((2 * half_m) ** 2, rel=2e-3)
    assert mixed.max() == 1


def test_edges_that_two_faces_share_and_tiles_without_any_edge_stay_as_they_are():
    tape = _box("tape_0", (-FAR_M, -FAR_M), (FAR_M, FAR_M), 1e-4)
    corners = tape.vertices
    middle = (0.0201, -FAR_M, 1e-4), (0.0201, FAR_M, 1e-4)
    halves = Mesh(
        "tape_0",
        (*corners, *middle),
        ((0, 4, 5, 3), (4, 1, 2, 5)),
        tape.uv_m * 2,
        tape.face_surface * 2,
    )
    values = np.random.default_rng(1).uniform(size=(SIDE + 2, SIDE + 2, 3)).astype(np.float32)
    layers = FloorLayers([_floor(), halves], 0.0)
    np.testing.assert_array_equal(layers.blended(TILE, values, np.ones((SIDE + 2, SIDE + 2))), values[1:-1, 1:-1])
    bare = FloorLayers([_floor()], 0.0)
    np.testing.assert_array_equal(bare.blended(TILE, values, np.zeros((SIDE + 2, SIDE + 2))), values[1:-1, 1:-1])

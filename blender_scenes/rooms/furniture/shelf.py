"""A shelf with books and boxes."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from blender_scenes.materials.fittings import painted
from blender_scenes.rooms.furniture import palette
from blender_scenes.rooms.furniture.base import Piece, between
from blender_scenes.scene.description import Mesh
from blender_scenes.scene.meshes import block
from blender_scenes.scene.solids import joined
from configs.schema.appearance.paint import Paint

_BOARD_M = 0.018
_PLINTH_M = 0.06


@dataclass(frozen=True)
class Item:
    """A book or box on a board."""

    board: int
    x_m: float
    """Distance of its left side from the left end of the board."""
    size_m: tuple[float, float, float]
    color: int


@dataclass(frozen=True)
class Shelf:
    """Dimensions, colour and content of a shelf."""

    size_m: tuple[float, float, float]
    """Width, depth and height."""
    boards: int
    """Number of boards, from the lowest one on the plinth to the lid."""
    body: Paint
    items: tuple[Item, ...]
    colors: tuple[Paint, ...]

    def board_top_m(self, board: int) -> float:
        return _PLINTH_M + _BOARD_M + board * (self.size_m[2] - _PLINTH_M - _BOARD_M) / (self.boards - 1)


def shelf(name: str, spec: Shelf) -> Piece:
    """Return a shelf of two sides, back, plinth and boards, with the items on it."""
    surfaces = [painted(f"{name}_body", spec.body, 0.45)]
    surfaces += [painted(f"{name}_item_{i}", paint, 0.6) for i, paint in enumerate(spec.colors)]
    return Piece(joined(name, [*_case(spec, f"{name}_body"), *_contents(spec, f"{name}_item")]), tuple(surfaces), spec)


def _case(spec: Shelf, body: str) -> Iterator[Mesh]:
    width, depth, height = spec.size_m
    inside = width - 2 * _BOARD_M
    for sign in (-1, 1):
        yield block("side", (sign * 0.5 * (width - _BOARD_M), 0, 0.5 * height), (_BOARD_M, depth, height), body)
    yield block("back", (0, 0.5 * depth - 0.002, 0.5 * height), (inside, 0.004, height), body)
    yield block("plinth", (0, -0.5 * depth + 0.03, 0.5 * _PLINTH_M), (inside, 0.018, _PLINTH_M), body)
    for board in range(spec.boards):
        z = spec.board_top_m(board) - 0.5 * _BOARD_M
        yield block("board", (0, -0.002, z), (inside, depth - 0.004, _BOARD_M), body)


def _contents(spec: Shelf, surface: str) -> Iterator[Mesh]:
    width, depth, _ = spec.size_m
    for item in spec.items:
        w, d, h = item.size_m
        x = -0.5 * width + _BOARD_M + item.x_m + 0.5 * w
        y = -0.5 * depth + 0.01 + 0.5 * d
        yield block("item", (x, y, spec.board_top_m(item.board) + 0.5 * h), item.size_m, f"{surface}_{item.color}")


def drawn_shelf(name: str, rng: np.random.Generator) -> Piece:
    size = between(rng, 0.6, 1.0), between(rng, 0.28, 0.4), between(rng, 0.9, 2.0)
    boards = max(3, round(size[2] / 0.36) + 1)
    colors = tuple(palette.print_color(rng) for _ in range(6))
    empty = Shelf(size, boards, palette.board(rng), (), colors)
    items = tuple(item for board in range(boards - 1) for item in _row(empty, board, rng))
    return shelf(name, Shelf(size, boards, empty.body, items, colors))


def _row(spec: Shelf, board: int, rng: np.random.Generator) -> Iterator[Item]:
    """Draw books and boxes from left to right, with gaps, until the board is full."""
    width, depth, _ = spec.size_m
    clear = spec.board_top_m(board + 1) - spec.board_top_m(board) - _BOARD_M
    full, x = width - 2 * _BOARD_M, between(rng, 0.0, 0.15)
    while True:
        box = rng.uniform() < 0.15
        w = between(rng, 0.18, 0.3) if box else between(rng, 0.018, 0.06)
        size = w, between(rng, 0.6, 0.85) * depth, clear * between(rng, 0.5, 0.9)
        if x + w > full:
            return
        yield Item(board, x, size, int(rng.integers(len(spec.colors))))
        x += w + (between(rng, 0.05, 0.25) if rng.uniform() < 0.12 else 0.002)

"""Books left on the floor."""

from dataclasses import dataclass

import numpy as np

from blender_scenes.materials.fittings import moulded, painted
from blender_scenes.rooms.furniture import palette
from blender_scenes.rooms.furniture.base import Piece, between
from blender_scenes.scene.meshes import block
from blender_scenes.scene.solids import joined, stood
from configs.schema.appearance.paint import Paint

_COVER_M = 0.002


@dataclass(frozen=True)
class Book:
    """Dimensions, place and colour of a book that lies flat."""

    size_m: tuple[float, float, float]
    """Width, height of the page, and thickness."""
    pose: tuple[float, float, float]
    """Pose in the frame of the stack: x [m], y [m], yaw [rad]."""
    cover: Paint


@dataclass(frozen=True)
class BookStack:
    """Books that lie on each other."""

    books: tuple[Book, ...]
    """Books from the lowest to the highest."""


def book_stack(name: str, spec: BookStack) -> Piece:
    """Return books, each a block of pages between two covers with a spine."""
    parts, z = [], 0.0
    for i, book in enumerate(spec.books):
        (w, d, t), cover = book.size_m, f"{name}_cover_{i}"
        one = [
            block("pages", (0.002, 0, z + 0.5 * t), (w - 0.008, d - 0.006, t - 2 * _COVER_M), f"{name}_pages"),
            block("spine", (-0.5 * w + 0.5 * _COVER_M, 0, z + 0.5 * t), (_COVER_M, d, t), cover),
        ]
        one += [block("cover", (0, 0, z + s), (w, d, _COVER_M), cover) for s in (0.5 * _COVER_M, t - 0.5 * _COVER_M)]
        parts += [stood(mesh, book.pose) for mesh in one]
        z += t
    surfaces = [moulded(f"{name}_pages", (0.72, 0.69, 0.6), 0.9)]
    surfaces += [painted(f"{name}_cover_{i}", book.cover, 0.35) for i, book in enumerate(spec.books)]
    return Piece(joined(name, parts), tuple(surfaces), spec)


def drawn_book_stack(name: str, rng: np.random.Generator) -> Piece:
    books = []
    for _ in range(int(rng.integers(1, 5))):
        size = between(rng, 0.13, 0.21), between(rng, 0.19, 0.297), between(rng, 0.01, 0.045)
        pose = between(rng, -0.02, 0.02), between(rng, -0.02, 0.02), between(rng, -0.3, 0.3)
        books.append(Book(size, pose, palette.print_color(rng)))
    return book_stack(name, BookStack(tuple(books)))

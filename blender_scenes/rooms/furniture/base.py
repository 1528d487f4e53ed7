"""A piece of furniture: one mesh in its own frame, with its surfaces and its size.

Each kind has a dataclass of numbers that describe a piece, a function that makes the piece from them, and a function
that draws them. The frame: origin on the floor below the middle, z up, x along the width, the back towards +y. A piece
on a wall has the wall's face at y = 0 and the room at -y.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np

from blender_scenes.scene.description import Mesh
from blender_scenes.scene.shading import Surface

T = TypeVar("T")


@dataclass(frozen=True)
class Piece:
    """A piece of furniture at the origin, with its surfaces and its random numbers."""

    mesh: Mesh
    surfaces: tuple[Surface, ...]
    numbers: object
    """Frozen dataclass from which it was made, such as `WorkTable`."""
    top_m: float | None = None
    """Height of a top on which things may stand."""

    @cached_property
    def size_m(self) -> tuple[float, float]:
        """Size of the footprint along x and y, with the origin in its middle."""
        vertices = np.abs(np.array(self.mesh.vertices)[:, :2])
        width, depth = 2 * vertices.max(axis=0)
        return float(width), float(depth)

    @cached_property
    def height_m(self) -> tuple[float, float]:
        """Heights of the lowest and the highest point."""
        heights = [vertex[2] for vertex in self.mesh.vertices]
        return min(heights), max(heights)


def between(rng: np.random.Generator, low: float, high: float) -> float:
    return float(rng.uniform(low, high))


def one_of(rng: np.random.Generator, options: Sequence[T]) -> T:
    return options[int(rng.integers(len(options)))]

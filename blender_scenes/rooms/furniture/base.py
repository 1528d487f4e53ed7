"""What every piece of furniture is: one mesh in a frame of its own, its surfaces, and the ground that it takes.

Each member of the family has numbers that describe a piece, a function from them to the piece, and one that draws them.
The frame: origin on the floor below the middle, z up, x along the width, the back towards +y. What hangs on a wall has
the wall's face as y = 0 and comes into the room towards -y.
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
    mesh: Mesh
    surfaces: tuple[Surface, ...]
    numbers: object
    """What it was made from: a frozen dataclass of its kind, such as `Table`."""
    top_m: float | None = None
    """Height of a top that things may stand on."""

    @cached_property
    def size_m(self) -> tuple[float, float]:
        """Extent along x and y of the ground that it takes, its origin in the middle."""
        vertices = np.abs(np.array(self.mesh.vertices)[:, :2])
        width, depth = 2 * vertices.max(axis=0)
        return float(width), float(depth)

    @cached_property
    def height_m(self) -> tuple[float, float]:
        """Lowest and highest point."""
        heights = [vertex[2] for vertex in self.mesh.vertices]
        return min(heights), max(heights)


def between(rng: np.random.Generator, low: float, high: float) -> float:
    return float(rng.uniform(low, high))


def one_of(rng: np.random.Generator, options: Sequence[T]) -> T:
    return options[int(rng.integers(len(options)))]

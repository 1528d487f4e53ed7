"""A printed poster on a wall."""

from dataclasses import dataclass

import numpy as np

from blender_scenes.materials.fittings import moulded, painted
from blender_scenes.rooms.furniture import palette
from blender_scenes.rooms.furniture.base import Piece, between, one_of
from blender_scenes.scene.meshes import block
from blender_scenes.scene.solids import joined
from configs.schema.appearance.paint import Paint

_FORMATS_M = ((0.42, 0.594), (0.594, 0.841), (0.841, 0.594))


@dataclass(frozen=True)
class Field:
    """A printed rectangle in shares of the poster's size."""

    center: tuple[float, float]
    size: tuple[float, float]
    paint: Paint


@dataclass(frozen=True)
class Poster:
    """Size, height and print of a poster."""

    size_m: tuple[float, float]
    sill_m: float
    """Height of its lower edge above the floor."""
    fields: tuple[Field, ...]


def poster(name: str, spec: Poster) -> Piece:
    """Return paper with coloured fields, each 0.4 mm above the one before."""
    width, height = spec.size_m
    parts = [block("paper", (0, -0.0005, spec.sill_m + 0.5 * height), (width, 0.001, height), f"{name}_paper")]
    for i, field in enumerate(spec.fields):
        at = field.center[0] * width, -0.0012 - 0.0004 * i, spec.sill_m + (0.5 + field.center[1]) * height
        size = field.size[0] * width, 0.0004, field.size[1] * height
        parts.append(block("field", at, size, f"{name}_field_{i}"))
    surfaces = [moulded(f"{name}_paper", (0.78, 0.77, 0.74), 0.5)]
    surfaces += [painted(f"{name}_field_{i}", field.paint, 0.45) for i, field in enumerate(spec.fields)]
    return Piece(joined(name, parts), tuple(surfaces), spec)


def drawn_poster(name: str, rng: np.random.Generator) -> Piece:
    fields = []
    for _ in range(int(rng.integers(2, 5))):
        size = between(rng, 0.3, 0.9), between(rng, 0.1, 0.6)
        center = tuple(between(rng, -0.47 + 0.5 * s, 0.47 - 0.5 * s) for s in size)
        fields.append(Field((center[0], center[1]), size, palette.print_color(rng)))
    return poster(name, Poster(one_of(rng, _FORMATS_M), between(rng, 0.9, 1.4), tuple(fields)))

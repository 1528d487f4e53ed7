"""A closed cardboard box."""

from dataclasses import dataclass

import numpy as np

from blender_scenes.materials.fittings import moulded, painted
from blender_scenes.rooms.furniture.base import Piece, between
from blender_scenes.scene.meshes import block
from blender_scenes.scene.solids import joined
from configs.schema.appearance.paint import Paint

_TAPE_M = 0.05


@dataclass(frozen=True)
class Carton:
    """Dimensions and colour of a cardboard box."""

    size_m: tuple[float, float, float]
    """Length, width and height."""
    board: Paint
    tape_drop_m: float
    """Length of the packing tape on both ends, from the top edge down."""
    label_m: float
    """Width of the label on the front; 0 for no label."""


def carton(name: str, spec: Carton) -> Piece:
    """Return a box with a strip of tape over its seam and down both ends, and a label."""
    length, width, height = spec.size_m
    parts = [block("box", (0, 0, 0.5 * height), spec.size_m, f"{name}_board")]
    parts.append(block("tape", (0, 0, height), (length + 0.0006, _TAPE_M, 0.0006), f"{name}_tape"))
    for sign in (-1, 1):
        at = (sign * 0.5 * length, 0, height - 0.5 * spec.tape_drop_m)
        parts.append(block("tape", at, (0.0006, _TAPE_M, spec.tape_drop_m), f"{name}_tape"))
    surfaces = [painted(f"{name}_board", spec.board, 0.9), moulded(f"{name}_tape", (0.32, 0.19, 0.08), 0.25)]
    if spec.label_m > 0:
        at = (0.2 * length, -0.5 * width, 0.5 * height)
        parts.append(block("label", at, (spec.label_m, 0.0006, 0.7 * spec.label_m), f"{name}_label"))
        surfaces.append(moulded(f"{name}_label", (0.75, 0.75, 0.73), 0.6))
    return Piece(joined(name, parts), tuple(surfaces), spec)


def drawn_carton(name: str, rng: np.random.Generator) -> Piece:
    size = between(rng, 0.22, 0.5), between(rng, 0.18, 0.38), between(rng, 0.14, 0.4)
    spec = Carton(
        size_m=size,
        board=Paint(reflectance=between(rng, 0.2, 0.36), hue_deg=between(rng, 27, 33), saturation=0.55),
        tape_drop_m=between(rng, 0.04, 0.1),
        label_m=between(rng, 0.06, 0.11) if rng.uniform() < 0.6 else 0.0,
    )
    return carton(name, spec)

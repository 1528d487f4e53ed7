"""A socket outlet in the wall."""

from dataclasses import dataclass

import numpy as np

from blender_scenes.materials.fittings import moulded
from blender_scenes.rooms.furniture.base import Piece, between
from blender_scenes.scene.meshes import block
from blender_scenes.scene.solids import joined

_PLATE_M = 0.081
"""Width of a frame for boxes of DIN 49073."""
_PITCH_M = 0.071


@dataclass(frozen=True)
class WallSocket:
    """Number and height of outlets in a wall."""

    count: int
    """Number of outlets side by side."""
    height_m: float
    """Height of their middle above the floor."""


def wall_socket(name: str, spec: WallSocket) -> Piece:
    """Return a plate with a dark well for each outlet."""
    width = _PLATE_M + (spec.count - 1) * _PITCH_M
    parts = [block("plate", (0, -0.005, spec.height_m), (width, 0.01, _PLATE_M), f"{name}_plate")]
    for i in range(spec.count):
        x = (i - 0.5 * (spec.count - 1)) * _PITCH_M
        parts.append(block("well", (x, -0.01, spec.height_m), (0.04, 0.001, 0.04), f"{name}_well"))
    surfaces = moulded(f"{name}_plate", (0.75, 0.74, 0.7), 0.3), moulded(f"{name}_well", (0.3, 0.3, 0.29), 0.4)
    return Piece(joined(name, parts), surfaces, spec)


def drawn_wall_socket(name: str, rng: np.random.Generator) -> Piece:
    return wall_socket(name, WallSocket(int(rng.integers(1, 4)), between(rng, 0.25, 0.35)))

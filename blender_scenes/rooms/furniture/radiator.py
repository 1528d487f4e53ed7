"""A panel radiator below the window."""

from dataclasses import dataclass

import numpy as np

from blender_scenes.materials.fittings import bare_metal, moulded
from blender_scenes.rooms.furniture.base import Piece, between
from blender_scenes.scene.meshes import block
from blender_scenes.scene.solids import joined, rod

_DEPTH_M = 0.075
_GAP_M = 0.03
"""Distance from the wall."""
_RIB_PITCH_M = 0.05
MIN_SILL_M = 0.45


@dataclass(frozen=True)
class Radiator:
    """Dimensions and place of a radiator."""

    length_m: float
    height_m: float
    lift_m: float
    """Height of its lower edge above the floor."""


def radiator(name: str, spec: Radiator) -> Piece:
    """Return a ribbed plate and two pipes that come out of the floor."""
    middle, z = -_GAP_M - 0.5 * _DEPTH_M, spec.lift_m + 0.5 * spec.height_m
    front = middle - 0.5 * _DEPTH_M
    parts = [block("body", (0, middle, z), (spec.length_m, _DEPTH_M, spec.height_m), f"{name}_enamel")]
    ribs = int((spec.length_m - 0.06) / _RIB_PITCH_M)
    for i in range(ribs):
        x = (i - 0.5 * (ribs - 1)) * _RIB_PITCH_M
        parts.append(block("rib", (x, front, z), (0.026, 0.012, spec.height_m - 0.06), f"{name}_enamel"))
    for x in (0.5 * spec.length_m - 0.03, 0.5 * spec.length_m - 0.08):
        foot, head = (x, middle, 0.0), (x, middle, spec.lift_m)
        parts.append(rod("pipe", (foot, head), (0.008, 0.008), f"{name}_pipes"))
    surfaces = moulded(f"{name}_enamel", (0.76, 0.75, 0.71), 0.25), bare_metal(f"{name}_pipes", (0.7, 0.45, 0.32), 0.35)
    return Piece(joined(name, parts), surfaces, spec)


def drawn_radiator(name: str, rng: np.random.Generator, *, window_m: float, sill_m: float) -> Piece:
    """Draw a radiator that fits below a window of that width, whose sill is at least `MIN_SILL_M` high."""
    lift = between(rng, 0.1, 0.14)
    height = min(between(rng, 0.4, 0.6), sill_m - lift - 0.08)
    return radiator(name, Radiator(window_m * between(rng, 0.6, 0.95), height, lift))

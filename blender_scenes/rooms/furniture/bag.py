"""A backpack that somebody left on the floor."""

from dataclasses import dataclass

import numpy as np

from blender_scenes.materials.fittings import painted
from blender_scenes.rooms.furniture import palette
from blender_scenes.rooms.furniture.base import Piece, between
from blender_scenes.scene.solids import cushion, joined, pipe
from configs.schema.appearance.paint import Paint

_STRAP_M = 0.011


@dataclass(frozen=True)
class Bag:
    """Dimensions and colours of a backpack."""

    size_m: tuple[float, float, float]
    """Width, depth and height."""
    cloth: Paint
    pocket: Paint


def bag(name: str, spec: Bag) -> Piece:
    """Return a full bag with a pocket in front, a handle, and two straps that lie behind it."""
    width, depth, height = spec.size_m
    parts = [
        cushion("body", (0, 0, 0.5 * height), spec.size_m, f"{name}_cloth"),
        cushion("pocket", (0, -0.42 * depth, 0.3 * height), (0.8 * width, 0.5 * depth, 0.5 * height), f"{name}_pocket"),
        pipe("handle", _arch(0.0, 0.04, 0.95 * height, 0.05), 0.008, f"{name}_pocket"),
    ]
    for side in (-0.25 * width, 0.25 * width):
        hang = np.linspace(0.0, 1.0, 8)
        y = 0.46 * depth + 0.09 * np.sin(np.pi * hang) + 0.03 * hang
        z = 0.85 * height * (1 - hang) + 1.4 * _STRAP_M  # its last ring leans
        path = [(side, float(a), float(b)) for a, b in zip(y, z, strict=True)]
        parts.append(pipe("strap", path, _STRAP_M, f"{name}_pocket"))
    surfaces = painted(f"{name}_cloth", spec.cloth, 0.85), painted(f"{name}_pocket", spec.pocket, 0.8)
    return Piece(joined(name, parts), surfaces, spec)


def _arch(x: float, half: float, foot: float, rise: float) -> list[tuple[float, float, float]]:
    return [(x + half * float(np.cos(a)), 0.0, foot + rise * float(np.sin(a))) for a in np.linspace(0, np.pi, 8)]


def drawn_bag(name: str, rng: np.random.Generator) -> Piece:
    cloth = palette.cloth(rng)
    size = between(rng, 0.26, 0.36), between(rng, 0.15, 0.22), between(rng, 0.36, 0.48)
    return bag(name, Bag(size, cloth, cloth if rng.uniform() < 0.5 else palette.cloth(rng)))

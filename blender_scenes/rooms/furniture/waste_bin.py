"""A waste-paper bin."""

from dataclasses import dataclass

import numpy as np

from blender_scenes.materials.fittings import painted
from blender_scenes.rooms.furniture import palette
from blender_scenes.rooms.furniture.base import Piece, between
from blender_scenes.scene.solids import lathe
from configs.schema.appearance.paint import Paint

_WALL_M = 0.003


@dataclass(frozen=True)
class WasteBin:
    """Dimensions and colour of a waste-paper bin, which is wider at the rim."""

    foot_radius_m: float
    rim_radius_m: float
    height_m: float
    paint: Paint


def waste_bin(name: str, spec: WasteBin) -> Piece:
    """Return an open cone with a rolled rim."""
    foot, rim, height = spec.foot_radius_m, spec.rim_radius_m, spec.height_m
    outside = [(foot, 0.0), (rim, height - 0.01), (rim + 0.005, height - 0.008), (rim + 0.005, height)]
    inside = [(rim - _WALL_M, height), (foot - _WALL_M, 0.004)]
    surfaces = (painted(f"{name}_wall", spec.paint, 0.4),)
    return Piece(lathe(name, [*outside, *inside], f"{name}_wall"), surfaces, spec)


def drawn_waste_bin(name: str, rng: np.random.Generator) -> Piece:
    foot = between(rng, 0.09, 0.13)
    return waste_bin(name, WasteBin(foot, foot + between(rng, 0.0, 0.04), between(rng, 0.25, 0.4), palette.cloth(rng)))

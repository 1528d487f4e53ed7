"""A table on four legs."""

from dataclasses import dataclass

import numpy as np

from blender_scenes.materials.fittings import moulded, painted
from blender_scenes.rooms.furniture import palette
from blender_scenes.rooms.furniture.base import Piece, between, one_of
from blender_scenes.scene.meshes import block
from blender_scenes.scene.solids import joined
from configs.schema.appearance.paint import Paint

_TOP_M = 0.025
_RAIL_M = 0.05
_CAP_M = 0.022


@dataclass(frozen=True)
class WorkTable:
    """Dimensions, colours and gloss of a table."""

    size_m: tuple[float, float, float]
    """Length, depth and height."""
    leg_m: float
    """Thickness of a leg."""
    inset_m: float
    """Distance of the legs from the edge of the top."""
    top: Paint
    legs: Paint
    gloss: float
    """Roughness of the top."""


def table(name: str, spec: WorkTable) -> Piece:
    """Return a top with rails below it and square legs in black caps."""
    (length, depth, height), leg = spec.size_m, spec.leg_m
    x, y = 0.5 * length - spec.inset_m - 0.5 * leg, 0.5 * depth - spec.inset_m - 0.5 * leg
    under = height - _TOP_M
    parts = [block("top", (0, 0, height - 0.5 * _TOP_M), (length, depth, _TOP_M), f"{name}_top")]
    for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        parts.append(block("leg", (sx * x, sy * y, 0.5 * (under + _CAP_M)), (leg, leg, under - _CAP_M), f"{name}_legs"))
        cap = leg + 0.004
        parts.append(block("cap", (sx * x, sy * y, 0.5 * _CAP_M), (cap, cap, _CAP_M), f"{name}_caps"))
    rail_z, thick = under - 0.5 * _RAIL_M, 0.6 * leg
    for sign in (-1, 1):
        parts.append(block("rail", (0, sign * y, rail_z), (2 * x - leg, thick, _RAIL_M), f"{name}_legs"))
        parts.append(block("rail", (sign * x, 0, rail_z), (thick, 2 * y - leg, _RAIL_M), f"{name}_legs"))
    surfaces = (
        painted(f"{name}_top", spec.top, spec.gloss),
        painted(f"{name}_legs", spec.legs, 0.35),
        moulded(f"{name}_caps", (0.02, 0.02, 0.02), 0.5),
    )
    return Piece(joined(name, parts), surfaces, spec, top_m=height)


def drawn_table(name: str, rng: np.random.Generator) -> Piece:
    size = one_of(rng, (0.7, 1.2, 1.3, 1.4, 1.6)), between(rng, 0.5, 0.7), between(rng, 0.70, 0.76)
    spec = WorkTable(
        size_m=size,
        leg_m=between(rng, 0.028, 0.06),
        inset_m=between(rng, 0.01, 0.08),
        top=palette.board(rng),
        legs=palette.frame(rng),
        gloss=between(rng, 0.25, 0.5),
    )
    return table(name, spec)

"""A closed door in its frame."""

from dataclasses import dataclass

import numpy as np

from blender_scenes.materials.fittings import bare_metal, painted
from blender_scenes.rooms.furniture import palette
from blender_scenes.rooms.furniture.base import Piece, between
from blender_scenes.scene.meshes import block
from blender_scenes.scene.solids import joined, rod
from configs.schema.appearance.paint import Paint

_FRAME_M = 0.07
_PROUD_M = 0.03
"""Depth of the frame in front of the wall; it covers the skirting."""


@dataclass(frozen=True)
class Door:
    """Dimensions and colours of a door."""

    width_m: float
    """Width of the leaf."""
    height_m: float
    leaf: Paint
    frame: Paint


def door(name: str, spec: Door) -> Piece:
    """Return leaf, frame and handle, with a gap above the threshold."""
    width, height = spec.width_m, spec.height_m
    parts = [block("leaf", (0, -0.01, 0.5 * height + 0.004), (width, 0.02, height - 0.008), f"{name}_leaf")]
    for sign in (-1, 1):
        at = (sign * 0.5 * (width + _FRAME_M), -0.5 * _PROUD_M, 0.5 * (height + _FRAME_M))
        parts.append(block("post", at, (_FRAME_M, _PROUD_M, height + _FRAME_M), f"{name}_frame"))
    parts.append(
        block("head", (0, -0.5 * _PROUD_M, height + 0.5 * _FRAME_M), (width, _PROUD_M, _FRAME_M), f"{name}_frame")
    )
    x = 0.5 * width - 0.06
    parts.append(rod("neck", ((x, -0.02, 1.05), (x, -0.065, 1.05)), (0.009, 0.009), f"{name}_handle"))
    parts.append(rod("handle", ((x + 0.01, -0.065, 1.05), (x - 0.12, -0.065, 1.05)), (0.01, 0.009), f"{name}_handle"))
    surfaces = (
        painted(f"{name}_leaf", spec.leaf, 0.4),
        painted(f"{name}_frame", spec.frame, 0.4),
        bare_metal(f"{name}_handle", (0.6, 0.6, 0.6), 0.3),
    )
    return Piece(joined(name, parts), surfaces, spec)


def drawn_door(name: str, rng: np.random.Generator) -> Piece:
    return door(name, Door(between(rng, 0.78, 0.92), between(rng, 1.9, 1.98), palette.board(rng), palette.frame(rng)))

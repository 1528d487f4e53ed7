"""Papers on the floor."""

from dataclasses import dataclass

import numpy as np

from blender_scenes.materials.fittings import painted
from blender_scenes.rooms.furniture.base import Piece, between
from blender_scenes.scene.meshes import block
from blender_scenes.scene.solids import joined, moved, stood
from configs.schema.appearance.paint import Paint

_A4_M = (0.210, 0.297)
_THICKNESS_M = 0.0004
"""Thickness of a sheet with the air below it."""


@dataclass(frozen=True)
class Sheets:
    """Places and colour of sheets of paper."""

    poses: tuple[tuple[float, float, float], ...]
    """Poses of the sheets, x [m], y [m], yaw [rad], from the lowest to the highest."""
    paper: Paint


def sheets(name: str, spec: Sheets) -> Piece:
    parts = []
    for i, pose in enumerate(spec.poses):
        sheet = block("sheet", (0, 0, 0.5 * _THICKNESS_M), (*_A4_M, _THICKNESS_M), f"{name}_paper")
        parts.append(moved(stood(sheet, pose), (0, 0, i * _THICKNESS_M)))
    return Piece(joined(name, parts), (painted(f"{name}_paper", spec.paper, 0.8),), spec)


def drawn_sheets(name: str, rng: np.random.Generator) -> Piece:
    count = int(rng.integers(1, 4))
    poses = [(between(rng, -0.08, 0.08), between(rng, -0.08, 0.08), between(rng, -0.8, 0.8)) for _ in range(count)]
    tint = Paint(reflectance=between(rng, 0.6, 0.82), hue_deg=between(rng, 40, 60), saturation=between(rng, 0.0, 0.15))
    return sheets(name, Sheets(tuple(poses), tint))

"""A swivel chair on five castors."""

from dataclasses import dataclass

import numpy as np

from blender_scenes.materials.fittings import bare_metal, moulded, painted
from blender_scenes.rooms.furniture import palette
from blender_scenes.rooms.furniture.base import Piece, between
from blender_scenes.scene.meshes import wheel
from blender_scenes.scene.solids import cushion, joined, rod, stood
from configs.schema.appearance.paint import Paint

_CASTOR_M = 0.025
_HUB_M = 0.09
"""Height of the upper end of the star's arms."""


@dataclass(frozen=True)
class OfficeChair:
    """Dimensions, angle and colour of a swivel chair."""

    base_radius_m: float
    """Radius of the star with the castors."""
    seat_height_m: float
    seat_width_m: float
    turn_rad: float
    """Angle of the star relative to the seat."""
    cover: Paint


def office_chair(name: str, spec: OfficeChair) -> Piece:
    """Return a star of five arms with twin castors, a gas spring, padded seat and back."""
    parts = []
    reach = spec.base_radius_m - 1.4 * _CASTOR_M
    for arm in range(5):
        angle = spec.turn_rad + 2 * np.pi * arm / 5
        tip = (reach, 0.0, 2 * _CASTOR_M + 0.012)
        pose = (0.0, 0.0, float(angle))
        parts.append(stood(rod("arm", ((0.0, 0.0, _HUB_M), tip), (0.024, 0.014), f"{name}_base"), pose))
        for side in (-0.013, 0.013):
            castor = wheel("castor", (reach, side, _CASTOR_M), _CASTOR_M, 0.018, f"{name}_castors")
            parts.append(stood(castor, pose))
    seat, width = spec.seat_height_m, spec.seat_width_m
    parts.append(rod("column", ((0, 0, _HUB_M - 0.02), (0, 0, seat - 0.08)), (0.03, 0.025), f"{name}_spring"))
    parts.append(cushion("seat", (0, 0, seat - 0.04), (width, width, 0.1), f"{name}_cover"))
    parts.append(
        rod("spine", ((0, 0.3 * width, seat - 0.06), (0, 0.5 * width, seat + 0.25)), (0.02, 0.02), f"{name}_base")
    )
    parts.append(cushion("back", (0, 0.46 * width, seat + 0.36), (0.9 * width, 0.08, 0.46), f"{name}_cover"))
    surfaces = (
        moulded(f"{name}_base", (0.03, 0.03, 0.03), 0.4),
        moulded(f"{name}_castors", (0.02, 0.02, 0.02), 0.35),
        bare_metal(f"{name}_spring", (0.5, 0.5, 0.5), 0.25),
        painted(f"{name}_cover", spec.cover, 0.9),
    )
    return Piece(joined(name, parts), surfaces, spec)


def drawn_office_chair(name: str, rng: np.random.Generator) -> Piece:
    spec = OfficeChair(
        base_radius_m=between(rng, 0.27, 0.33),
        seat_height_m=between(rng, 0.44, 0.54),
        seat_width_m=between(rng, 0.44, 0.5),
        turn_rad=between(rng, 0.0, 2 * np.pi / 5),
        cover=palette.cloth(rng),
    )
    return office_chair(name, spec)

"""A chair on four legs."""

from dataclasses import dataclass

import numpy as np

from blender_scenes.materials.fittings import moulded, painted
from blender_scenes.rooms.furniture import palette
from blender_scenes.rooms.furniture.base import Piece, between
from blender_scenes.scene.meshes import block
from blender_scenes.scene.solids import joined, rod
from configs.schema.appearance.paint import Paint

_SEAT_M = 0.02
_FOOT_M = 0.02


@dataclass(frozen=True)
class Chair:
    """Dimensions and colours of a chair."""

    width_m: float
    depth_m: float
    seat_height_m: float
    back_height_m: float
    """Height of the back's upper edge above the floor."""
    leg_radius_m: float
    splay_m: float
    """Distance outwards from the top of a leg to its foot."""
    seat: Paint
    frame: Paint


def chair(name: str, spec: Chair) -> Piece:
    """Return a chair with round splayed legs on rubber feet, a rail on each side, seat and back rest."""
    half_w, half_d, seat, radius = 0.5 * spec.width_m, 0.5 * spec.depth_m, spec.seat_height_m, spec.leg_radius_m
    inner = np.array([half_w - spec.splay_m - radius, half_d - spec.splay_m - radius])
    parts = []
    for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        sign = np.array([sx, sy])
        head, foot = sign * inner, sign * (inner + spec.splay_m)
        fx, fy = float(foot[0]), float(foot[1])
        shoe = 1.25 * radius
        parts.append(rod("foot", ((fx, fy, 0.0), (fx, fy, _FOOT_M)), (shoe, shoe), f"{name}_feet"))
        head_at = float(head[0]), float(head[1]), seat
        parts.append(rod("leg", ((fx, fy, 0.5 * _FOOT_M), head_at), (radius, radius), f"{name}_frame"))
    x, y = float(inner[0]), float(inner[1])
    for side in (-x, x):
        parts.append(
            rod("rail", ((side, -y, seat - 0.015), (side, y, seat - 0.015)), (radius, radius), f"{name}_frame")
        )
        post = (side, y, seat), (side, y + 0.5 * spec.splay_m, spec.back_height_m - 0.02)
        parts.append(rod("post", post, (radius, radius), f"{name}_frame"))
    parts.append(
        block("seat", (0, 0, seat + 0.5 * _SEAT_M), (2 * half_w - 0.02, 2 * half_d - 0.02, _SEAT_M), f"{name}_seat")
    )
    rest = 0.45 * (spec.back_height_m - seat)
    back = (0, y - radius - 0.006, spec.back_height_m - 0.5 * rest)
    parts.append(block("back", back, (2 * half_w - 0.02, 0.012, rest), f"{name}_seat"))
    surfaces = (
        painted(f"{name}_seat", spec.seat, 0.4),
        painted(f"{name}_frame", spec.frame, 0.3),
        moulded(f"{name}_feet", (0.025, 0.025, 0.025), 0.7),
    )
    return Piece(joined(name, parts), surfaces, spec)


def drawn_chair(name: str, rng: np.random.Generator) -> Piece:
    seat = between(rng, 0.42, 0.46)
    spec = Chair(
        width_m=between(rng, 0.38, 0.46),
        depth_m=between(rng, 0.38, 0.46),
        seat_height_m=seat,
        back_height_m=seat + between(rng, 0.33, 0.42),
        leg_radius_m=between(rng, 0.01, 0.016),
        splay_m=between(rng, 0.0, 0.04),
        seat=palette.board(rng) if rng.uniform() < 0.5 else palette.cloth(rng),
        frame=palette.frame(rng),
    )
    return chair(name, spec)

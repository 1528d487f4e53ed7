"""A drinking bottle."""

from dataclasses import dataclass

import numpy as np

from blender_scenes.materials.fittings import painted
from blender_scenes.rooms.furniture import palette
from blender_scenes.rooms.furniture.base import Piece, between
from blender_scenes.scene.solids import joined, lathe
from configs.schema.appearance.paint import Paint


@dataclass(frozen=True)
class Bottle:
    """Dimensions and colours of a bottle."""

    radius_m: float
    height_m: float
    """Height with the cap."""
    body: Paint
    cap: Paint


def bottle(name: str, spec: Bottle) -> Piece:
    """Return a bottle of body, shoulder and screw cap."""
    r, shoulder = spec.radius_m, spec.height_m - 0.06
    body = [(0.9 * r, 0.0), (r, 0.006), (r, shoulder), (0.8 * r, shoulder + 0.018), (0.45 * r, shoulder + 0.028)]
    cap = [(0.5 * r, shoulder + 0.028), (0.5 * r, spec.height_m - 0.003), (0.4 * r, spec.height_m)]
    parts = [lathe("body", body, f"{name}_body"), lathe("cap", cap, f"{name}_cap")]
    surfaces = painted(f"{name}_body", spec.body, 0.2), painted(f"{name}_cap", spec.cap, 0.4)
    return Piece(joined(name, parts), surfaces, spec)


def drawn_bottle(name: str, rng: np.random.Generator) -> Piece:
    spec = Bottle(between(rng, 0.03, 0.042), between(rng, 0.18, 0.3), palette.print_color(rng), palette.cloth(rng))
    return bottle(name, spec)

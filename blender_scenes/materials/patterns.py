"""Marks that many surfaces share, as masks 0-1: specks, streaks, stains."""

import math
from dataclasses import replace

from blender_scenes.materials.base import Patch
from blender_scenes.shading import Arithmetic, Cells, Noise, Step, Texture


def specks(patch: Patch, name: str, *, per_m: float, radius_m: float, share: float) -> Texture:
    """Irregular specks in a `share` of the cells of a random grid, `per_m` cells along each side of a metre."""
    cells = Cells((per_m, per_m), patch.offset(name), "distance")
    radius = radius_m * per_m
    ragged = 2.0 * radius * Noise((4 * per_m, 4 * per_m), patch.offset(f"{name} outline"), octaves=1)
    near = 1 - Step(cells + ragged, 1.2 * radius, 2.2 * radius)
    chosen = 1 - Step(replace(cells, value="random"), share - 0.01, share + 0.01)
    return near * chosen


def streaks(patch: Patch, name: str, *, length_m: float, width_m: float, share: float) -> Texture:
    """Thin, slightly bent marks of one random direction; `share` 0-1 is how thickly they lie."""
    turn = math.tau * patch.draw(f"{name} direction")
    grain = Noise((1 / length_m, 1 / width_m), patch.offset(name), octaves=2, warp=0.35, turn_rad=turn)
    level = 0.76 - 0.2 * share
    return Step(grain, level, level + 0.15)


def stains(patch: Patch, name: str, *, size_m: float, share: float) -> Texture:
    """Soft irregular patches; `share` 0-1 is how much of the surface they cover."""
    cloud = Noise((1 / size_m, 1 / size_m), patch.offset(name), octaves=4, gain=0.6, warp=0.4)
    level = 0.66 - 0.3 * share
    return Step(cloud, level, level + 0.35)


def either(a: Texture, b: Texture) -> Texture:
    """The stronger of two masks."""
    return Arithmetic("maximum", a, b)

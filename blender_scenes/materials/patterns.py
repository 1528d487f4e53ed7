"""Marks that many surfaces share, as masks 0-1: specks, streaks, stains."""

import math

from blender_scenes.materials.base import Patch
from blender_scenes.shading import Arithmetic, Noise, Step, Texture

_SEAM = 0.274


def specks(patch: Patch, name: str, *, size_m: float, share: float) -> Texture:
    """Irregular specks about `size_m` across; `share` 0-1 is how thickly they lie."""
    level = 0.88 - 0.12 * share
    return Step(Noise((0.5 / size_m, 0.5 / size_m), patch.offset(name), octaves=1), level, level + 0.05)


def streaks(patch: Patch, name: str, *, length_m: float, width_m: float, share: float) -> Texture:
    """Thin marks of one random direction; `share` 0-1 is how thickly they lie."""
    turn = math.tau * patch.draw(f"{name} direction")
    grain = Noise((1 / length_m, 1 / width_m), patch.offset(name), octaves=2, turn_rad=turn)
    level = 0.76 - 0.2 * share
    return Step(grain, level, level + 0.15)


def stains(patch: Patch, name: str, *, size_m: float, share: float) -> Texture:
    """Soft irregular patches; `share` 0-1 is how much of the surface they cover."""
    cloud = Noise((1 / size_m, 1 / size_m), patch.offset(name), octaves=3, gain=0.6)
    level = 0.66 - 0.3 * share
    return Step(cloud, level, level + 0.35)


def either(a: Texture, b: Texture) -> Texture:
    """The stronger of two masks."""
    return Arithmetic("maximum", a, b)


def worn_gloss(roughness: float, by: Texture, depth: float) -> Texture:
    """Roughness that varies by `depth` with a pattern of mean 0.5, about `roughness` where it may.

    It stays on one side of 0.274: there Cycles begins to count a gloss as colour in what it tells the denoiser
    (`fabs(roughness^2) > 0.075`), and the border would show in the picture.
    """
    low = roughness - 0.5 * depth
    highest_below = max(_SEAM - 0.006 - depth, 0.0)
    low = max(low, _SEAM + 0.006) if roughness >= _SEAM else max(min(low, highest_below), 0.0)
    return low + depth * by

"""Marks that many surfaces share, as masks 0-1: specks, streaks, blotches, arcs, threads."""

import math

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.scene.shading import Arithmetic, Cells, Mix, NoiseTexture, Step, Texture, paint_color
from configs.schema.appearance.paint import Paint

_GUIDE_ROUGHNESS = 0.274
"""Roughness above which Cycles treats gloss as diffuse in the denoiser's guide (`fabs(roughness^2) > 0.075`)."""


def shaded(tone: Texture, paint: Paint, spread: float) -> Mix:
    """Return the paint from `1 - spread` of its reflectance, where `tone` is 0, to `1 + spread`, where it is 1."""
    return Mix(tone, paint_color(paint, times=1 - spread), paint_color(paint, times=1 + spread))


def specks(patch: SurfacePatch, name: str, *, size_m: float, share: float) -> Texture:
    """Return irregular specks about `size_m` wide; `share` is their density from 0 to 1."""
    level = 0.88 - 0.12 * share
    return Step(NoiseTexture((0.5 / size_m, 0.5 / size_m), patch.offset(name), octaves=1), level, level + 0.05)


def streaks(patch: SurfacePatch, name: str, *, length_m: float, width_m: float, share: float) -> Texture:
    """Return thin marks in one random direction; `share` is their density from 0 to 1."""
    turn = math.tau * patch.draw(f"{name} direction")
    grain = NoiseTexture((1 / length_m, 1 / width_m), patch.offset(name), octaves=2, turn_rad=turn)
    level = 0.76 - 0.2 * share
    return Step(grain, level, level + 0.15)


def blotches(patch: SurfacePatch, name: str, *, size_m: float, share: float) -> Texture:
    """Return soft irregular patches; `share` is the covered share of the surface."""
    cloud = NoiseTexture((1 / size_m, 1 / size_m), patch.offset(name), octaves=3, gain=0.6)
    level = 0.66 - 0.3 * share
    return Step(cloud, level, level + 0.35)


def arcs(patch: SurfacePatch, name: str, *, radius_m: float, width_m: float, share: float, apart_m: float) -> Texture:
    """Return curved smears, at most one in each cell about `apart_m` wide; `share` of the cells have one."""
    per_m, offset = (1 / apart_m, 1 / apart_m), patch.offset(name)
    hand = NoiseTexture((0.8 / radius_m, 0.8 / radius_m), patch.offset(f"{name} hand"), octaves=2)
    away = Cells(per_m, offset, "distance") + (0.9 * radius_m / apart_m) * (hand - 0.5)
    radius, half = radius_m / apart_m, 0.5 * width_m / apart_m
    # Sharp on the inside and fading outwards, like the mark of a heel that turns.
    smear = Step(away, radius - half, radius - 0.4 * half) * (1 - Step(away, radius - 0.2 * half, radius + 2 * half))
    here = Step(Cells(per_m, offset, "random"), 1 - share, 1.01 - share)
    return smear * here * Step(hand, 0.5, 0.62)


def threads(patch: SurfacePatch, name: str, *, size_m: float, width_m: float) -> Texture:
    """Return fine wandering lines, where a noise with features of `size_m` crosses its mean."""
    field = NoiseTexture((1 / size_m, 1 / size_m), patch.offset(name), octaves=5, gain=0.55)
    slope = 1.6 / size_m  # slope of the noise where it crosses its mean, measured in rendered images
    away = Arithmetic("maximum", field - 0.5, 0.5 - field)
    return 1 - Step(away, 0.2 * slope * width_m, 0.7 * slope * width_m)


def either(a: Texture, b: Texture) -> Texture:
    """Return the maximum of two masks."""
    return Arithmetic("maximum", a, b)


def worn_gloss(roughness: float, by: Texture, depth: float) -> Texture:
    """Return a roughness that varies by `depth` with a pattern of mean 0.5, about `roughness` where possible.

    It stays on one side of the roughness above which Cycles treats gloss as diffuse in the denoiser's guide: the border
    would be visible in the image.
    """
    low = roughness - 0.5 * depth
    highest_below = max(_GUIDE_ROUGHNESS - 0.006 - depth, 0.0)
    low = max(low, _GUIDE_ROUGHNESS + 0.006) if roughness >= _GUIDE_ROUGHNESS else max(min(low, highest_below), 0.0)
    return low + depth * by

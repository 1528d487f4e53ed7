"""Planed softwood board."""

import math

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.scene.shading import Arithmetic, Mix, NoiseTexture, Step, Surface, paint_color
from configs.schema.appearance.look import LookConfig


def wood(look: LookConfig, patch: SurfacePatch) -> Surface:
    """Return wood with growth rings along u, fibres and a matt varnish."""
    config = look.wood
    stem = NoiseTexture((0.8, 11.0), patch.offset("stem"), octaves=2, gain=0.3)
    rings = Step(Arithmetic("sine", (24 * math.tau) * stem), -0.6, 1.0)
    clouds = NoiseTexture((2.0, 30.0), patch.offset("clouds"), octaves=3)
    fibres = NoiseTexture((30.0, 900.0), patch.offset("fibres"), octaves=2)
    base = Mix(
        0.45 * (1 - rings) + 0.35 * clouds + 0.25 * fibres,
        paint_color(config.paint, times=0.6),
        paint_color(config.paint, times=1.35),
    )
    return Surface(patch.name, base, roughness=config.roughness + 0.1 * fibres, height_m=0.00002 * fibres)

"""Planed softwood board."""

from blender_scenes.colour import paint_color
from blender_scenes.materials.base import Patch
from blender_scenes.shading import Mix, Noise, Step, Surface
from configs.schema.look import LookConfig


def wood(look: LookConfig, patch: Patch) -> Surface:
    """Growth rings along u, fibres, a varnish left matt."""
    own = look.wood
    rings = Noise((1.8, 55.0), patch.offset("rings"), octaves=3, gain=0.5, warp=0.8)
    fibres = Noise((30.0, 900.0), patch.offset("fibres"), octaves=2)
    base = Mix(
        0.7 * Step(rings, 0.3, 0.7) + 0.3 * fibres,
        paint_color(own.paint, times=0.68),
        paint_color(own.paint, times=1.25),
    )
    return Surface(patch.name, base, roughness=own.roughness + 0.1 * fibres, height_m=0.00002 * fibres)

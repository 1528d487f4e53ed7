"""Corrugated brown cardboard."""

from blender_scenes.colour import paint_color
from blender_scenes.materials.base import Patch
from blender_scenes.shading import Mix, Noise, Surface
from configs.schema.look import LookConfig


def cardboard(look: LookConfig, patch: Patch) -> Surface:
    """Kraft paper with short fibres."""
    own = look.cardboard
    fibres = Noise((900.0, 120.0), patch.offset("fibres"), octaves=3)
    base = Mix(fibres, paint_color(own.paint, times=0.88), paint_color(own.paint, times=1.12))
    return Surface(patch.name, base, roughness=0.85)

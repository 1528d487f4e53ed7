"""Tape of the line."""

from blender_scenes.colour import paint_color
from blender_scenes.materials.base import Patch
from blender_scenes.shading import Mix, Noise, Surface
from configs.schema.look import TapeLook


def tape(look: TapeLook, patch: Patch) -> Surface:
    """Matt black tape."""
    cloud = Noise((60.0, 200.0), patch.offset("scuffs"), octaves=3)
    base = Mix(cloud, paint_color(look.paint, times=0.8), paint_color(look.paint, times=1.2))
    return Surface(patch.name, base, roughness=look.roughness)

"""Painted board of a given reflectance."""

from collections.abc import Callable

from blender_scenes.colour import paint_color
from blender_scenes.materials.base import Patch
from blender_scenes.shading import Mix, Noise, Surface
from configs.schema.look import LookConfig, Paint


def board(reflectance: float) -> Callable[[LookConfig, Patch], Surface]:
    """The material of a board painted to `reflectance`."""

    def painted(look: LookConfig, patch: Patch) -> Surface:
        own = look.boards
        paint = Paint(reflectance=reflectance, hue_deg=own.tint_hue_deg, saturation=own.tint_saturation)
        cloud = Noise((6.0, 6.0), patch.offset("clouds"), octaves=4)
        roller = Noise((450.0, 450.0), patch.offset("roller"), octaves=2)
        spread = 0.05 * own.wear
        base = Mix(cloud, paint_color(paint, times=1 - spread), paint_color(paint, times=1 + spread))
        return Surface(patch.name, base, roughness=own.roughness + 0.1 * cloud, height_m=0.00004 * roller)

    return painted

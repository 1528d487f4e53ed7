"""Marbled linoleum sheet."""

from blender_scenes.colour import paint_color
from blender_scenes.materials.base import Patch
from blender_scenes.materials.patterns import specks
from blender_scenes.shading import Mix, Noise, Step, Surface
from configs.schema.look import FloorLook


def linoleum(look: FloorLook, patch: Patch) -> Surface:
    """Streaks of a few centimetres along the sheet, flecks of two shades, a wax gloss worn in clouds."""
    own = look.linoleum
    depth = own.marbling
    streaks = Noise((9.0, 38.0), patch.offset("streaks"), octaves=4, gain=0.6, warp=0.6)
    light = specks(patch, "light flecks", per_m=220.0, radius_m=0.0007, share=0.3)
    dark = specks(patch, "dark flecks", per_m=180.0, radius_m=0.0008, share=0.3)
    base = Mix(
        Step(streaks, 0.25, 0.75), paint_color(own.paint, times=1 - depth), paint_color(own.paint, times=1 + depth)
    )
    base = Mix(0.5 * light, base, paint_color(own.paint, times=1 + 2.5 * depth))
    base = Mix(0.5 * dark, base, paint_color(own.paint, times=1 - 2 * depth))
    wear = Noise((2.5, 2.5), patch.offset("wear"), octaves=3)
    hammered = Noise((260.0, 260.0), patch.offset("hammered"), octaves=1)
    return Surface(patch.name, base, roughness=own.roughness - 0.1 + 0.2 * wear, height_m=0.00003 * hammered)

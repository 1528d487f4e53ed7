"""Marbled linoleum sheet."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.marks.patterns import shaded, specks, worn_gloss
from blender_scenes.scene.shading import Mix, NoiseTexture, Step, Surface, paint_color
from configs.schema.appearance.floors import FloorLook


def linoleum(look: FloorLook, patch: SurfacePatch) -> Surface:
    """Return streaks of a few centimetres along the sheet, flecks of two shades, and an unevenly worn wax gloss."""
    config = look.linoleum
    depth = config.marbling
    streaks = NoiseTexture((9.0, 38.0), patch.offset("streaks"), octaves=4, gain=0.6, warp=0.6)
    light = specks(patch, "light flecks", size_m=0.0022, share=0.5)
    dark = specks(patch, "dark flecks", size_m=0.0026, share=0.5)
    base = shaded(Step(streaks, 0.25, 0.75), config.paint, depth)
    base = Mix(0.5 * light, base, paint_color(config.paint, times=1 + 2.5 * depth))
    base = Mix(0.5 * dark, base, paint_color(config.paint, times=1 - 2 * depth))
    wear = NoiseTexture((2.5, 2.5), patch.offset("wear"), octaves=2)
    return Surface(patch.name, base, roughness=worn_gloss(config.roughness, wear, 0.2))

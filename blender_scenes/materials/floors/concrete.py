"""Power-floated, sealed concrete."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.marks.patterns import shaded, specks, threads, worn_gloss
from blender_scenes.scene.shading import Mix, NoiseTexture, Step, Surface, paint_color
from configs.schema.appearance.floors import FloorLook


def concrete(look: FloorLook, patch: SurfacePatch) -> Surface:
    """Return concrete with clouds of decimetres, sand grain of a millimetre, pores, and hairline cracks."""
    config = look.concrete
    clouds = NoiseTexture((2.6, 2.6), patch.offset("clouds"), octaves=6, gain=0.62)
    grain = NoiseTexture((650.0, 650.0), patch.offset("grain"), octaves=2)
    base = shaded(Step(0.8 * clouds + 0.2 * grain, 0.25, 0.75), config.paint, config.clouding)
    pores = specks(patch, "pores", size_m=0.0018, share=0.3)
    crack = threads(patch, "cracks", size_m=1.5, width_m=0.0008)
    base = Mix(0.6 * pores, base, paint_color(config.paint, times=0.45))
    base = Mix(0.8 * crack * Step(clouds, 0.5, 0.58), base, paint_color(config.paint, times=0.3))
    return Surface(patch.name, base, roughness=worn_gloss(config.roughness, clouds, 0.3))

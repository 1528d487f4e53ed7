"""Varnished wooden parquet."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.marks.patterns import shaded, worn_gloss
from blender_scenes.scene.shading import Mix, NoiseTexture, Step, Surface, Tiles, paint_color
from configs.schema.appearance.floors import FloorLook


def parquet(look: FloorLook, patch: SurfacePatch) -> Surface:
    """Return staggered planks of different tones with growth rings, pores along the grain, and dark gaps."""
    config = look.parquet
    size, offset = (config.plank_length_m, config.plank_width_m), patch.offset("planks")
    gap = Tiles(size, config.gap_m, 0.37, offset, "joint", softness=0.5)
    plank = Tiles(size, config.gap_m, 0.37, offset, "random")
    rings = NoiseTexture((2.2, 70.0), patch.offset("rings"), octaves=3, gain=0.55, warp=0.5, shift=50 * plank)
    fibres = NoiseTexture((25.0, 800.0), patch.offset("fibres"), octaves=2, gain=0.6, shift=50 * plank)
    tone = 0.5 * plank + 0.32 * Step(rings, 0.25, 0.75) + 0.18 * fibres
    wood = shaded(tone, config.paint, config.variation)
    pores = Step(fibres, 0.62, 0.75)
    wood = Mix(0.35 * pores, wood, paint_color(config.paint, times=0.35))
    return Surface(
        patch.name,
        Mix(gap, wood, paint_color(config.paint, times=0.12)),
        roughness=worn_gloss(config.roughness, fibres, 0.15),
        height_m=-0.0003 * gap,
        refractive_index=1.5,
    )

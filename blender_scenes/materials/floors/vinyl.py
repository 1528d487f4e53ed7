"""Cushioned vinyl with a print of planks or of terrazzo."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.marks.patterns import shaded, worn_gloss
from blender_scenes.scene.shading import Cells, Mix, NoiseTexture, Step, Surface, Texture, Tiles, paint_color
from configs.schema.appearance.floors import FloorLook, Vinyl


def vinyl(look: FloorLook, patch: SurfacePatch) -> Surface:
    """Return the print under a clear coat that follows the dents; joints are printed and have no depth."""
    config = look.vinyl
    base = _planks(config, patch) if config.print == "planks" else _terrazzo(config, patch)
    dents = NoiseTexture((7.0, 7.0), patch.offset("dents"), octaves=2)
    emboss = NoiseTexture((350.0, 350.0), patch.offset("emboss"), octaves=1)
    wear = NoiseTexture((2.5, 2.5), patch.offset("wear"), octaves=2)
    return Surface(
        patch.name,
        base,
        roughness=worn_gloss(config.roughness, wear, 0.15),
        height_m=0.0006 * dents + 0.00002 * emboss,
        refractive_index=1.5,
    )


def _planks(config: Vinyl, patch: SurfacePatch) -> Texture:
    size, offset = (6.5 * config.repeat_m, config.repeat_m), patch.offset("planks")
    joint = Tiles(size, 0.002, 0.31, offset, "joint", softness=0.8)
    plank = Tiles(size, 0.002, 0.31, offset, "random")
    flow = NoiseTexture((1.3, 26.0), patch.offset("flow"), octaves=4, gain=0.55, warp=0.5, shift=40 * plank)
    fibres = NoiseTexture((20.0, 500.0), patch.offset("fibres"), octaves=2, shift=40 * plank)
    tone = 0.3 * plank + 0.5 * Step(flow, 0.3, 0.7) + 0.2 * fibres
    wood = shaded(tone, config.paint, config.variation)
    return Mix(0.8 * joint, wood, paint_color(config.paint, times=0.3))


def _terrazzo(config: Vinyl, patch: SurfacePatch) -> Texture:
    """Return angular chips of three sizes in grey, some lighter, some darker, some reddish."""
    sand = NoiseTexture((500.0, 500.0), patch.offset("sand"), octaves=2)
    ground = shaded(sand, config.paint, 0.04)
    for number, size_m in enumerate((0.1 * config.repeat_m, 0.045 * config.repeat_m, 0.02 * config.repeat_m)):
        per_m, at = (1 / size_m, 1 / size_m), patch.offset(f"chips {number}")
        shade = Cells(per_m, at, "random")
        inside = Step(Cells(per_m, at, "edge"), 0.07, 0.1)
        light = Step(shade, 0.8, 0.81)
        dark = 1 - Step(shade, 0.19, 0.2)
        ground = Mix(0.9 * light * inside, ground, paint_color(config.paint, times=1 + 1.6 * config.variation))
        ground = Mix(0.9 * dark * inside, ground, paint_color(config.paint, times=1 - 1.6 * config.variation))
    return ground

"""White paper laid out in sheets."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.marks.patterns import shaded, threads
from blender_scenes.scene.shading import Mix, NoiseTexture, Step, Surface, Tiles, paint_color
from configs.schema.appearance.floors import FloorLook

_OVERLAP_M = 0.012


def paper_sheets(look: FloorLook, patch: SurfacePatch) -> Surface:
    """Return sheets that overlap a little, of different whites, waved, folded in places and taped along the seams."""
    config = look.paper_sheets
    size, offset = (config.sheet_length_m, config.sheet_width_m), patch.offset("sheets")
    beside = offset[0] + 0.5 * _OVERLAP_M, offset[1] + 0.5 * _OVERLAP_M
    sheet = Tiles(size, 0.0, 0.35, offset, "random")
    edge = Tiles(size, 0.0016, 0.35, offset, "joint", softness=1.0)
    double = Tiles(size, _OVERLAP_M, 0.35, beside, "joint", softness=0.02)
    formation = NoiseTexture((30.0, 30.0), patch.offset("formation"), octaves=4)
    tone = 0.6 * sheet + 0.2 * formation + 0.2 * double
    base = shaded(tone, config.paint, config.variation)
    base = Mix(0.45 * edge, base, paint_color(config.paint, times=0.35))
    waves = NoiseTexture((4.0, 6.0), patch.offset("waves"), octaves=2, shift=40 * sheet)
    folds = threads(patch, "folds", size_m=0.45, width_m=0.004) * Step(formation, 0.42, 0.55)
    tooth = NoiseTexture((900.0, 900.0), patch.offset("tooth"), octaves=1)
    height = config.buckling * (0.004 * waves + 0.0004 * folds) + 0.0002 * double + 0.00001 * tooth
    roughness = config.roughness
    if config.tape_width_m:
        tape = Tiles(size, config.tape_width_m, 0.35, offset, "joint", softness=0.05)
        base = Mix(0.5 * tape, base, paint_color(config.paint, times=0.93))
        roughness = config.roughness - max(config.roughness - 0.3, 0.0) * tape
    return Surface(patch.name, base, roughness=roughness, height_m=height)

"""Loop-pile carpet tiles."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.marks.patterns import shaded
from blender_scenes.scene.shading import Cells, Mix, NoiseTexture, Surface, Tiles, paint_color
from configs.schema.appearance.floors import FloorLook


def carpet(look: FloorLook, patch: SurfacePatch) -> Surface:
    """Return rows of round loops of yarn of mixed shades, trodden down in places, with slightly deeper seams."""
    config = look.carpet
    size = (config.tile_size_m, config.tile_size_m)
    offset = patch.offset("tiles")
    seam = Tiles(size, 0.6 * config.loop_m, 0.0, offset, "joint", softness=1.0)
    tile = Tiles(size, 0.6 * config.loop_m, 0.0, offset, "random")
    per_m = (0.8 / config.loop_m, 1.2 / config.loop_m)
    at = patch.offset("loops")
    from_top, yarn = Cells(per_m, at, "distance"), Cells(per_m, at, "random")
    bands = NoiseTexture((3.0, 45.0), patch.offset("dye"), octaves=3, gain=0.6, shift=40 * tile)
    trodden = NoiseTexture((3.5, 3.5), patch.offset("trodden"), octaves=3)
    tone = 0.5 * yarn + 0.25 * bands + 0.15 * trodden + 0.1 * tile
    pile = shaded(tone, config.paint, config.mottling)
    # Little light leaves the gaps between loops: they are dark because they are deep.
    deep = 0.55 * from_top + 0.5 * seam - 0.22
    pile = Mix(deep, pile, paint_color(config.paint, times=0.25))
    height = config.loop_m * (0.25 * (1 - from_top) + 0.1 * trodden - 0.4 * seam)
    return Surface(patch.name, pile, roughness=1.0, height_m=height, refractive_index=1.2)

"""Glazed ceramic tiles with grouted joints."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.marks.patterns import blotches, shaded, specks
from blender_scenes.scene.shading import Mix, NoiseTexture, Surface, Tiles, paint_color
from configs.schema.appearance.floors import FloorLook

_ROUNDED_M = 0.0012


def ceramic_tile(look: FloorLook, patch: SurfacePatch) -> Surface:
    """Return square tiles in straight rows, each of a slightly different shade, with rounded edges.

    Joints are lower, rough and sandy, with patches of dirt.
    """
    config = look.ceramic_tile
    size, offset = (config.size_m, config.size_m), patch.offset("courses")
    joint = Tiles(size, config.joint_width_m, 0.0, offset, "joint", softness=0.3)
    edge = Tiles(size, config.joint_width_m + 2 * _ROUNDED_M, 0.0, offset, "joint", softness=1.0)
    batch = Tiles(size, config.joint_width_m, 0.0, offset, "random")
    cloud = NoiseTexture((11.0, 11.0), patch.offset("clouds"), octaves=4, gain=0.55, shift=40 * batch)
    tile = shaded(0.55 * batch + 0.45 * cloud, config.paint, 1.5 * config.variation)
    tile = Mix(specks(patch, "pepper", size_m=0.0012, share=0.4), tile, paint_color(config.paint, times=0.8))
    sand = NoiseTexture((500.0, 500.0), patch.offset("sand"), octaves=2)
    grout = shaded(sand, config.joint, 0.25)
    grime = blotches(patch, "grime in the joints", size_m=0.12, share=0.4)
    grout = Mix(0.6 * grime, grout, paint_color(config.joint, times=0.4))
    waves = NoiseTexture((14.0, 14.0), patch.offset("glaze"), octaves=1, shift=40 * batch)
    return Surface(
        patch.name,
        Mix(joint, tile, grout),
        roughness=config.roughness + 0.65 * joint,
        height_m=0.00006 * waves - 0.0006 * edge - 0.0006 * joint,
        refractive_index=1.5,
    )

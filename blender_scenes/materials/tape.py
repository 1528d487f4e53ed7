"""Adhesive tape of the line."""

from blender_scenes.colour import paint_color
from blender_scenes.materials.base import Patch
from blender_scenes.materials.patterns import either, specks, streaks
from blender_scenes.shading import Color, Coordinate, Mix, Noise, Step, Surface
from configs.schema.look import TapeLook


def tape(look: TapeLook, patch: Patch) -> Surface:
    """Matt film with a crepe across it, its own tone per piece, scuffs, dust, polished spots and dirt in the joints."""
    length, _ = patch.size_m
    tone = 0.85 + 0.3 * patch.draw("tone")
    rubbed = Noise((22.0, 60.0), patch.offset("rubbed"), octaves=4, gain=0.6, warp=0.4)
    scuffs = either(
        streaks(patch, "scuffs along", length_m=0.03, width_m=0.0012, share=0.45 * look.wear),
        streaks(patch, "scuffs across", length_m=0.018, width_m=0.0009, share=0.4 * look.wear),
    )
    dust = specks(patch, "dust", size_m=0.0008, share=0.5 * look.wear)
    base = Mix(rubbed, paint_color(look.paint, times=0.8 * tone), paint_color(look.paint, times=1.25 * tone))
    base = Mix(0.30 * look.wear * Step(rubbed, 0.5, 0.7), base, Color((0.16, 0.15, 0.14)))
    base = Mix(0.35 * scuffs, base, Color((0.25, 0.24, 0.22)))
    base = Mix(0.6 * dust, base, Color((0.4, 0.38, 0.35)))
    along = Coordinate("u")
    end = either(1 - Step(along, 0.0001, 0.0005), Step(along, length - 0.0005, length - 0.0001))
    base = Mix(0.7 * end, base, Color((0.22, 0.20, 0.18)))
    waves = Noise((30.0, 14.0), patch.offset("waves"), octaves=2)
    polished = 0.18 * look.wear * Step(rubbed, 0.52, 0.66)
    return Surface(
        patch.name,
        base,
        roughness=look.roughness + 0.08 - polished,
        height_m=0.00012 * waves,
        refractive_index=1.42,
    )

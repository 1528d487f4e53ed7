"""Paint of a painted line."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.marks.patterns import either, shaded, specks, streaks, worn_gloss
from blender_scenes.scene.shading import Color, Mix, NoiseTexture, Step, Surface, SurfaceCoordinate
from configs.schema.appearance.look import LinePaintLook


def line_paint(look: LinePaintLook, patch: SurfacePatch) -> Surface:
    """Return brushed paint with streaks, thin at its edges and in places, scuffed and dusty with use."""
    brush = NoiseTexture((14.0, 900.0), patch.offset("brush"), octaves=3, gain=0.6)
    clouds = NoiseTexture((25.0, 40.0), patch.offset("clouds"), octaves=4, gain=0.6)
    base = shaded(0.5 * brush + 0.5 * clouds, look.paint, 0.3)
    across, width = SurfaceCoordinate("v"), patch.size_m[1]
    rim = either(1 - Step(across, 0.0, 0.0012), Step(across, width - 0.0012, width))
    thin = either(0.5 * rim * Step(clouds, 0.4, 0.6), look.wear * Step(0.6 * clouds + 0.4 * brush, 0.56, 0.72))
    base = Mix(0.35 * thin, base, Color((0.3, 0.29, 0.27)))
    nicks = streaks(patch, "nicks", length_m=0.02, width_m=0.0012, share=0.35 * look.wear)
    base = Mix(0.3 * nicks, base, Color((0.3, 0.28, 0.26)))
    base = Mix(0.5 * specks(patch, "dust", size_m=0.0009, share=0.5 * look.wear), base, Color((0.4, 0.38, 0.35)))
    return Surface(
        patch.name,
        base,
        roughness=worn_gloss(look.roughness, clouds, 0.15),
        height_m=0.00002 * brush + 0.00004 * clouds,
        refractive_index=1.42,
    )

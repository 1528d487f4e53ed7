"""Painted boards of the arena's walls."""

from collections.abc import Callable

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.marks.patterns import shaded, streaks, worn_gloss
from blender_scenes.scene.shading import Color, Mix, NoiseTexture, Step, Surface, SurfaceCoordinate, Tiles
from configs.schema.appearance.look import LookConfig, Paint


def board(reflectance: float) -> Callable[[LookConfig, SurfacePatch], Surface]:
    """Return the material of boards painted to `reflectance`."""

    def painted(look: LookConfig, patch: SurfacePatch) -> Surface:
        """Return boards with joints, and with scuffs and grime along the floor."""
        config = look.boards
        paint = Paint(reflectance=reflectance, hue_deg=config.tint_hue_deg, saturation=config.tint_saturation)
        cloud = NoiseTexture((5.0, 5.0), patch.offset("clouds"), octaves=3)
        base = shaded(cloud, paint, 0.03)
        height = SurfaceCoordinate("v")
        grime = 1 - Step(height + 0.012 * cloud, 0.004, 0.022)
        scuffs = streaks(patch, "scuffs", length_m=0.06, width_m=0.003, share=0.3 * config.wear)
        low = 1 - Step(height, 0.03, 0.09)
        base = Mix(0.35 * config.wear * grime, base, Color((0.18, 0.16, 0.13)))
        base = Mix(0.3 * scuffs * low, base, Color((0.1, 0.1, 0.1)))
        first = config.length_m * patch.draw("first board")
        seam = Tiles((config.length_m, 10.0), 0.0012, 0.0, (first, 5.0), "joint", softness=0.5)
        base = Mix(0.7 * seam, base, Color((0.08, 0.07, 0.06)))
        return Surface(patch.name, base, roughness=worn_gloss(config.roughness, cloud, 0.1))

    return painted

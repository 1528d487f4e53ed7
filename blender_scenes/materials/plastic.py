"""Injection-moulded plastic."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.marks.patterns import streaks
from blender_scenes.scene.shading import Mix, NoiseTexture, Surface, paint_color
from configs.schema.appearance.look import LookConfig


def plastic(look: LookConfig, patch: SurfacePatch) -> Surface:
    """Return plastic of one colour with a fine grain and light scratches."""
    config = look.plastic
    scratches = streaks(patch, "scratches", length_m=0.03, width_m=0.0006, share=0.25)
    grain = NoiseTexture((1100.0, 1100.0), patch.offset("grain"), octaves=2)
    return Surface(
        patch.name,
        Mix(0.15 * scratches, paint_color(config.paint), paint_color(config.paint, times=1.4)),
        roughness=config.roughness + 0.15 * scratches,
        height_m=0.00001 * grain,
        refractive_index=1.5,
    )

"""Brushed aluminium sheet."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.scene.shading import Color, Mix, NoiseTexture, Surface
from configs.schema.appearance.look import LookConfig


def metal(look: LookConfig, patch: SurfacePatch) -> Surface:
    """Return slightly oxidised aluminium, brushed along u."""
    brushed = NoiseTexture((6.0, 1500.0), patch.offset("brush"), octaves=3)
    cloud = NoiseTexture((12.0, 12.0), patch.offset("clouds"), octaves=3)
    return Surface(
        patch.name,
        Mix(brushed, Color((0.62, 0.63, 0.64)), Color((0.82, 0.83, 0.84))),
        roughness=look.metal.roughness + 0.1 * cloud,
        height_m=0.000004 * brushed,
        metallic=1.0,
    )

"""White drawing paper on a body."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.marks.patterns import shaded
from blender_scenes.scene.shading import NoiseTexture, Surface
from configs.schema.appearance.look import LookConfig


def paper(look: LookConfig, patch: SurfacePatch) -> Surface:
    """Return a matt sheet with a fine grain, slightly buckled."""
    config = look.paper
    cloud = NoiseTexture((30.0, 30.0), patch.offset("formation"), octaves=4)
    buckles = NoiseTexture((9.0, 5.0), patch.offset("buckles"), octaves=2)
    tooth = NoiseTexture((1200.0, 1200.0), patch.offset("tooth"), octaves=2)
    return Surface(
        patch.name,
        shaded(cloud, config.paint, 0.03),
        roughness=config.roughness,
        height_m=0.0008 * buckles + 0.00001 * tooth,
    )

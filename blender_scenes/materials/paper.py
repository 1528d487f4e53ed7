"""White drawing paper on a body."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.scene.shading import Mix, NoiseTexture, Surface, paint_color
from configs.schema.look import LookConfig


def paper(look: LookConfig, patch: SurfacePatch) -> Surface:
    """Matt sheet with a fine tooth, faintly buckled."""
    own = look.paper
    cloud = NoiseTexture((30.0, 30.0), patch.offset("formation"), octaves=4)
    buckles = NoiseTexture((9.0, 5.0), patch.offset("buckles"), octaves=2)
    tooth = NoiseTexture((1200.0, 1200.0), patch.offset("tooth"), octaves=2)
    return Surface(
        patch.name,
        Mix(cloud, paint_color(own.paint, times=0.97), paint_color(own.paint, times=1.03)),
        roughness=own.roughness,
        height_m=0.0008 * buckles + 0.00001 * tooth,
    )

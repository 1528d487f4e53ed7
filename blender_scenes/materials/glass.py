"""Clear float glass."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.scene.shading import Color, NoiseTexture, Surface
from configs.schema.appearance.look import LookConfig


def glass(look: LookConfig, patch: SurfacePatch) -> Surface:
    """Return slightly green glass with finger marks in the gloss."""
    film = NoiseTexture((9.0, 9.0), patch.offset("film"), octaves=4)
    return Surface(
        patch.name,
        Color((0.93, 0.965, 0.95)),
        roughness=look.glass.roughness * film,
        refractive_index=1.52,
        transmission=1.0,
    )

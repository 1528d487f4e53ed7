"""What use leaves on a floor: a film of dust in clouds, dark rubber scuffs, crumbs and lint."""

from dataclasses import replace

from blender_scenes.materials.base import Patch
from blender_scenes.materials.patterns import either, specks, stains, streaks
from blender_scenes.shading import Arithmetic, Color, Mix, Surface, as_texture


def dirtied(surface: Surface, patch: Patch, amount: float) -> Surface:
    """The floor after `amount` 0-1 of use."""
    if amount == 0:
        return surface
    film = stains(patch, "film", size_m=0.5, share=0.5)
    scuffs = either(
        streaks(patch, "scuff a", length_m=0.09, width_m=0.006, share=0.3 * amount),
        streaks(patch, "scuff b", length_m=0.06, width_m=0.004, share=0.3 * amount),
    )
    crumbs = specks(patch, "crumbs", per_m=28.0, radius_m=0.0007, share=0.12 * amount)
    base = Mix(0.12 * amount * film, surface.base_color, Color((0.30, 0.28, 0.25)))
    base = Mix(0.35 * scuffs, base, Color((0.06, 0.055, 0.05)))
    base = Mix(0.8 * crumbs, base, Color((0.12, 0.10, 0.08)))
    roughness = as_texture(surface.roughness) + 0.15 * amount * film
    return replace(surface, base_color=base, roughness=Arithmetic("minimum", roughness, as_texture(1.0)))

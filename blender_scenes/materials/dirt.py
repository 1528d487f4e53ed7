"""What use leaves on a floor: a film of dust in clouds, dark rubber scuffs, crumbs and lint."""

from dataclasses import replace

from blender_scenes.materials.base import Patch
from blender_scenes.materials.patterns import specks, stains, streaks
from blender_scenes.shading import Color, Mix, Surface


def dirtied(surface: Surface, patch: Patch, amount: float) -> Surface:
    """The floor after `amount` 0-1 of use."""
    if amount == 0:
        return surface
    film = stains(patch, "film", size_m=0.4, share=0.5)
    scuffs = streaks(patch, "scuffs", length_m=0.09, width_m=0.006, share=0.35 * amount)
    crumbs = specks(patch, "crumbs", size_m=0.0016, share=0.12 * amount)
    base = Mix(0.12 * amount * film, surface.base_color, Color((0.30, 0.28, 0.25)))
    base = Mix(0.35 * scuffs, base, Color((0.06, 0.055, 0.05)))
    base = Mix(0.6 * crumbs, base, Color((0.12, 0.10, 0.08)))
    return replace(surface, base_color=base)

"""Darker and paler patches of a floor: traffic, faded and cleaned places, dried spills."""

from dataclasses import replace

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.scene.shading import Color, Mix, NoiseTexture, Step, Surface

_GRIME = Color((0.07, 0.065, 0.06))
_CHALK = Color((0.72, 0.71, 0.69))
"""Colour of scuffs and dried water, which are hardly visible on a white floor."""


def stained(surface: Surface, patch: SurfacePatch, amount: float) -> Surface:
    """Return the floor with darker and paler patches, of standard deviation about a tenth at `amount` 1.

    A dried spill is a slightly paler area with a dark rim where the floor around it is clean.
    """
    if amount == 0:
        return surface
    traffic = NoiseTexture((1 / 0.16, 1 / 0.16), patch.offset("traffic"), octaves=4, gain=0.6)
    spills = NoiseTexture((1 / 0.12, 1 / 0.12), patch.offset("spills"), octaves=3, gain=0.45)
    base = Mix(0.34 * amount * (1 - Step(traffic, 0.32, 0.52)), surface.base_color, _GRIME)
    base = Mix(0.16 * amount * Step(traffic, 0.48, 0.68), base, _CHALK)
    within, rim = Step(spills, 0.6, 0.64), Step(spills, 0.58, 0.61) * (1 - Step(spills, 0.61, 0.66))
    base = Mix(0.15 * amount * within, base, _CHALK)
    base = Mix(0.25 * amount * (rim * Step(traffic, 0.42, 0.6)), base, _GRIME)
    return replace(surface, base_color=base)

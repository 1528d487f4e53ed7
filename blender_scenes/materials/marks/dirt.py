"""Traces of use on a floor: dust, footprints, marks of rubber heels, crumbs."""

from dataclasses import replace

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.marks.patterns import arcs, blotches, either, specks
from blender_scenes.scene.shading import Color, Mix, NoiseTexture, Step, Surface, Texture

_DUST = Color((0.33, 0.31, 0.28))
_RUBBER = Color((0.05, 0.047, 0.044))


def dirtied(surface: Surface, patch: SurfacePatch, amount: float) -> Surface:
    """Return the floor after an `amount` of use from 0 to 1."""
    if amount == 0:
        return surface
    grain = NoiseTexture((150.0, 150.0), patch.offset("grain of dirt"), octaves=4, gain=0.75)
    film = blotches(patch, "film", size_m=0.4, share=0.5)
    feet = blotches(patch, "feet", size_m=0.07, share=0.25)
    crumbs = specks(patch, "crumbs", size_m=0.0014, share=0.05 * amount)
    base = Mix(amount * (0.06 * film + 0.16 * feet * grain), surface.base_color, _DUST)
    base = Mix(_rubber(patch, amount) * Step(grain, 0.35, 0.85), base, _RUBBER)
    base = Mix(0.5 * crumbs, base, Color((0.12, 0.10, 0.08)))
    return replace(surface, base_color=base)


def _rubber(patch: SurfacePatch, amount: float) -> Texture:
    """Return marks of heels that turned on the spot, and of soles and chair legs that slid."""
    turned = arcs(patch, "heels", radius_m=0.03, width_m=0.007, share=0.5 * amount, apart_m=0.14)
    slid = arcs(patch, "slides", radius_m=0.12, width_m=0.01, share=0.6 * amount, apart_m=0.4)
    return either(0.75 * turned, 0.5 * slid)

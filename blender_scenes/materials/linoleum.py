"""Marbled linoleum sheet."""

from blender_scenes.colour import paint_color
from blender_scenes.materials.base import Patch
from blender_scenes.shading import Mix, Noise, Step, Surface
from configs.schema.look import FloorLook


def linoleum(look: FloorLook, patch: Patch) -> Surface:
    """Directional marbling of centimetres, fine fibres of millimetres, a wax gloss worn in clouds."""
    own = look.linoleum
    streaks = Noise((14.0, 42.0), patch.offset("streaks"), octaves=5, gain=0.55, warp=1.2)
    base = Mix(
        Step(streaks, 0.3, 0.7),
        paint_color(own.paint, times=1 - own.marbling),
        paint_color(own.paint, times=1 + own.marbling),
    )
    worn = Noise((2.5, 2.5), patch.offset("wear"), octaves=3)
    return Surface(patch.name, base, roughness=own.roughness + 0.2 * worn)

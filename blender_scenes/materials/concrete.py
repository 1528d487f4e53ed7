"""Power-floated concrete."""

from blender_scenes.colour import paint_color
from blender_scenes.materials.base import Patch
from blender_scenes.shading import Mix, Noise, Surface
from configs.schema.look import FloorLook


def concrete(look: FloorLook, patch: Patch) -> Surface:
    """Clouds of decimetres, sand grain of a millimetre."""
    own = look.concrete
    clouds = Noise((3.0, 3.0), patch.offset("clouds"), octaves=6, gain=0.6)
    grain = Noise((700.0, 700.0), patch.offset("grain"), octaves=2)
    base = Mix(
        0.75 * clouds + 0.25 * grain,
        paint_color(own.paint, times=1 - own.clouding),
        paint_color(own.paint, times=1 + own.clouding),
    )
    return Surface(patch.name, base, roughness=own.roughness + 0.2 * clouds)

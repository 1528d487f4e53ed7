"""Power-floated, sealed concrete."""

from blender_scenes.colour import paint_color
from blender_scenes.materials.base import Patch
from blender_scenes.materials.patterns import specks
from blender_scenes.shading import Cells, Mix, Noise, Step, Surface
from configs.schema.look import FloorLook


def concrete(look: FloorLook, patch: Patch) -> Surface:
    """Clouds of decimetres, sand grain of a millimetre, pores, and hairline cracks metres apart."""
    own = look.concrete
    clouds = Noise((2.6, 2.6), patch.offset("clouds"), octaves=6, gain=0.62, warp=0.5)
    grain = Noise((650.0, 650.0), patch.offset("grain"), octaves=2)
    base = Mix(
        Step(0.8 * clouds + 0.2 * grain, 0.25, 0.75),
        paint_color(own.paint, times=1 - own.clouding),
        paint_color(own.paint, times=1 + own.clouding),
    )
    pores = specks(patch, "pores", per_m=150.0, radius_m=0.0006, share=0.15)
    crack = 1 - Step(Cells((1.1, 1.1), patch.offset("cracks"), "edge"), 0.0, 0.0012)
    fading = Step(Noise((3.0, 3.0), patch.offset("crack fading"), octaves=2), 0.45, 0.6)
    base = Mix(0.6 * pores, base, paint_color(own.paint, times=0.45))
    base = Mix(0.5 * crack * fading, base, paint_color(own.paint, times=0.3))
    return Surface(
        patch.name,
        base,
        roughness=own.roughness - 0.12 + 0.3 * clouds,
        height_m=0.00004 * grain - 0.0003 * pores,
    )

"""Corrugated brown cardboard."""

import math

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.marks.patterns import either, shaded, specks, streaks
from blender_scenes.scene.shading import Arithmetic, Mix, NoiseTexture, Step, Surface, SurfaceCoordinate, paint_color
from configs.schema.appearance.look import LookConfig

_FLUTE_PITCH_M = 0.0065


def cardboard(look: LookConfig, patch: SurfacePatch) -> Surface:
    """Return kraft liner with fibres, faint upright ribs of the flutes, worn edges and a strip of packing tape.

    The strip runs over the top and down the middle of the sides.
    """
    config = look.cardboard
    width, height = patch.size_m
    u, v = SurfaceCoordinate("u"), SurfaceCoordinate("v")
    fibres = NoiseTexture((900.0, 140.0), patch.offset("fibres"), octaves=3, gain=0.6)
    blotches = NoiseTexture((16.0, 16.0), patch.offset("blotches"), octaves=3)
    rib = Arithmetic("sine", u * (math.tau / _FLUTE_PITCH_M))
    tone = 0.4 * fibres + 0.45 * blotches + 0.05 * rib + 0.05
    base = shaded(tone, config.paint, 0.28)
    base = Mix(0.5 * specks(patch, "shives", size_m=0.0012, share=0.3), base, paint_color(config.paint, times=0.5))
    margin = 0.0014
    edge = either(1 - Step(u, 0.0, margin), Step(u, width - margin, width))
    base = Mix(0.8 * config.wear * edge, base, paint_color(config.paint, times=1.5))
    creases = streaks(patch, "creases", length_m=0.04, width_m=0.0015, share=0.5 * config.wear)
    base = Mix(0.3 * creases, base, paint_color(config.paint, times=0.55))
    tape = _strip(u, width, 0.045) * Step(v, height - config.tape_drop_m, height - config.tape_drop_m + 0.0003)
    base = Mix(0.85 * tape, base, paint_color(config.tape))
    return Surface(
        patch.name, base, roughness=0.88 - 0.65 * tape, height_m=0.00005 * rib + 0.00003 * fibres + 0.00006 * tape
    )


def _strip(u: SurfaceCoordinate, width: float, strip: float) -> Arithmetic:
    """Return 1 on a strip of that width in the middle of the face, at most two thirds of the face; 0 elsewhere."""
    half = 0.5 * min(strip, 0.66 * width)
    return Step(u, 0.5 * width - half, 0.5 * width - half + 0.0003) * (
        1 - Step(u, 0.5 * width + half - 0.0003, 0.5 * width + half)
    )

"""Raw plywood: peeled veneer with its wide growth lines, and the plies of a sawn edge."""

import math

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.marks.patterns import either, shaded, specks
from blender_scenes.scene.shading import (
    Arithmetic,
    Constant,
    Mix,
    NoiseTexture,
    Step,
    Surface,
    SurfaceCoordinate,
    Texture,
    paint_color,
)
from configs.schema.appearance.look import LookConfig
from configs.schema.appearance.paint import Paint

_PLY_M = 0.0015
_THICKEST_EDGE_M = 0.03
"""Maximum width of a face that counts as the sawn edge of a sheet; wider faces have veneer."""


def plywood(look: LookConfig, patch: SurfacePatch) -> Surface:
    """Return veneer for a face, or the cut plies for the edge of a sheet."""
    config = look.plywood
    if min(patch.size_m) <= _THICKEST_EDGE_M:
        return _sawn_edge(look, patch)
    face, fibres = veneer(patch, config.paint, 0.15, Constant(0.5))
    return Surface(patch.name, face, roughness=config.roughness + 0.1 * fibres, height_m=0.00003 * fibres)


def veneer(patch: SurfacePatch, paint: Paint, variation: float, sheet: Texture) -> tuple[Texture, Texture]:
    """Return colour and fibres of a peeled face; growth lines wander like the contours of a hilly map."""
    hills = NoiseTexture((0.55, 4.5), patch.offset("hills"), octaves=2, gain=0.35, warp=0.15, shift=30 * sheet)
    fibres = NoiseTexture((18.0, 850.0), patch.offset("fibres"), octaves=2, gain=0.6, shift=30 * sheet)
    clouds = NoiseTexture((1.6, 9.0), patch.offset("clouds"), octaves=3, shift=30 * sheet)
    contour = Arithmetic("sine", (34 * math.tau) * hills)
    late = Step(contour, 0.7, 1.0)  # latewood: narrow, dark, sharp on one side
    tone = 0.5 + 0.3 * (sheet - 0.5) + 0.9 * (clouds - 0.5) + 0.5 * (fibres - 0.5) - 0.3 * (late - 0.1)
    face = shaded(tone, paint, 2 * variation)
    pores = Step(fibres, 0.64, 0.78)
    face = Mix(0.3 * pores, face, paint_color(paint, times=0.5))
    return Mix(0.6 * specks(patch, "flecks", size_m=0.0012, share=0.2), face, paint_color(paint, times=0.45)), fibres


def _sawn_edge(look: LookConfig, patch: SurfacePatch) -> Surface:
    """Return alternating light and dark plies along the long side of the face."""
    config = look.plywood
    across, grain = ("u", (600.0, 40.0)) if patch.size_m[0] < patch.size_m[1] else ("v", (40.0, 600.0))
    ply = Step(Arithmetic("sine", SurfaceCoordinate(across) * (math.pi / _PLY_M)), -0.3, 0.3)
    fibres = NoiseTexture(grain, patch.offset("sawn"), octaves=3)
    light, dark = paint_color(config.paint, times=1.0), paint_color(config.paint, times=0.5)
    burnt = either(0.3 * ply, Step(fibres, 0.62, 0.75) * 0.5)
    base = Mix(0.75 * ply + 0.25 * fibres, light, dark)
    return Surface(patch.name, Mix(0.3 * burnt, base, paint_color(config.paint, times=0.25)), roughness=0.8)

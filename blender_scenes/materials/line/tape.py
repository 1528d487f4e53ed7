"""Adhesive tape of the line."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.marks.patterns import either, specks, streaks, worn_gloss
from blender_scenes.scene.shading import (
    Color,
    Mix,
    NoiseTexture,
    Step,
    Surface,
    SurfaceCoordinate,
    Texture,
    paint_color,
)
from configs.schema.appearance.look import TapeLook

_SHARPEST_BEND_PER_M = 5.0
"""Curvature from which on a tape folds all along its inner edge."""


def tape(look: TapeLook, patch: SurfacePatch, bend_per_m: float = 0.0, bed_m: float = 0.0) -> Surface:
    """Return matt or glossy film with scuffs, dust, polished spots, streaks, dirty ends, and folds in bends.

    `bend_per_m` is the piece's curvature, positive to the left; `bed_m` the size of a carpet's loops, which press
    through from beneath, 0 on a hard floor.
    """
    length, width = patch.size_m
    tone = 0.85 + 0.3 * patch.draw("tone")
    rubbed = NoiseTexture((22.0, 60.0), patch.offset("rubbed"), octaves=4, gain=0.6, warp=0.4)
    fine = NoiseTexture((60.0, 2200.0), patch.offset("fine scratches"), octaves=2)
    nicks = streaks(patch, "nicks", length_m=0.018, width_m=0.0009, share=0.3 * look.wear)
    dust = specks(patch, "dust", size_m=0.0008, share=0.5 * look.wear)
    base = Mix(rubbed, paint_color(look.paint, times=0.8 * tone), paint_color(look.paint, times=1.25 * tone))
    worn = Step(rubbed, 0.5, 0.72)
    base = Mix(look.wear * worn * (0.12 + 0.4 * Step(fine, 0.5, 0.75)), base, Color((0.2, 0.19, 0.18)))
    base = Mix(0.3 * nicks, base, Color((0.25, 0.24, 0.22)))
    base = Mix(0.6 * dust, base, Color((0.4, 0.38, 0.35)))
    along, across = SurfaceCoordinate("u"), SurfaceCoordinate("v")
    end = _ends(along, length, 0.0004)
    gum = _ends(across, width, 0.0006) * rubbed  # dust sticks where the glue comes out
    base = Mix(0.7 * end, base, Color((0.22, 0.20, 0.18)))
    base = Mix(0.5 * look.wear * gum, base, Color((0.33, 0.31, 0.28)))
    crepe = NoiseTexture((700.0, 160.0), patch.offset("crepe"), octaves=2)
    waves = NoiseTexture((30.0, 14.0), patch.offset("waves"), octaves=2)
    height = 0.00012 * waves + (0.00003 * look.roughness) * crepe + _folds(look, patch, bend_per_m, fine=waves)
    if bed_m:
        height = height + 0.5 * bed_m * NoiseTexture((0.4 / bed_m, 0.4 / bed_m), patch.offset("bed"), octaves=2)
    matt, depth, mean = 1 - worn, 0.16 * look.wear, min(look.roughness + 0.05, 1.0)
    if look.streaks:
        streaked, more = _streaks(patch), 0.1 * look.streaks
        base = Mix(0.8 * look.streaks * streaked, base, Color((0.35, 0.34, 0.33)))
        # Between streaks the tape is as rough as without them.
        mean -= 0.5 * more
        matt, depth = (depth * matt + more * (1 - streaked)) * (1 / (depth + more)), depth + more
    roughness = worn_gloss(mean, matt, depth)
    return Surface(patch.name, base, roughness=roughness, height_m=height, refractive_index=1.42)


def _streaks(patch: SurfacePatch) -> Texture:
    """Return scuffs along the tape and the haze around them, 0 to 1, in patches some centimetres long.

    They have no relief, which at the size of a camera's pixel is not seen.
    """
    fine = NoiseTexture((1 / 0.014, 1 / 0.0024), patch.offset("streaks"), octaves=3, gain=0.65)
    thick = NoiseTexture((1 / 0.06, 1 / 0.03), patch.offset("patches of streaks"), octaves=2)
    return Step(thick, 0.46, 0.74) * (0.2 + 0.8 * Step(fine, 0.54, 0.68))


def _ends(at: SurfaceCoordinate, size_m: float, border_m: float) -> Texture:
    """Return 1 along both borders of a strip of that size, 0 elsewhere."""
    return either(1 - Step(at, 0.2 * border_m, border_m), Step(at, size_m - border_m, size_m - 0.2 * border_m))


def _folds(look: TapeLook, patch: SurfacePatch, bend_per_m: float, fine: Texture) -> Texture:
    """Return the height [m] of folds across the tape: along the inner edge of bends, and in a few other places."""
    inside = SurfaceCoordinate("v") if bend_per_m > 0 else patch.size_m[1] - SurfaceCoordinate("v")
    sharp = min(abs(bend_per_m) / _SHARPEST_BEND_PER_M, 1.0)
    share = Step(inside, 0.3 * patch.size_m[1], patch.size_m[1])
    pleats = Step(NoiseTexture((170.0, 9.0), patch.offset("pleats"), octaves=2), 0.52, 0.72)
    somewhere = Step(fine, 0.6, 0.7)
    return (0.0006 * look.wrinkles) * pleats * (sharp * share + 0.4 * somewhere)

"""Oiled wooden parquet."""

from blender_scenes.colour import paint_color
from blender_scenes.materials.base import Patch
from blender_scenes.shading import Mix, Noise, Surface, Tiles
from configs.schema.look import FloorLook


def parquet(look: FloorLook, patch: Patch) -> Surface:
    """Planks in ship's-deck bond with grain along them and narrow dark gaps."""
    own = look.parquet
    size, offset = (own.plank_length_m, own.plank_width_m), patch.offset("planks")
    gap = Tiles(size, own.gap_m, 0.37, offset, "joint")
    plank = Tiles(size, own.gap_m, 0.37, offset, "random")
    grain = Noise((6.0, 260.0), patch.offset("grain"), octaves=4, gain=0.6, warp=0.4)
    wood = Mix(
        0.6 * plank + 0.4 * grain,
        paint_color(own.paint, times=1 - own.variation),
        paint_color(own.paint, times=1 + own.variation),
    )
    return Surface(
        patch.name,
        Mix(gap, wood, paint_color(own.paint, times=0.15)),
        roughness=own.roughness + 0.15 * grain,
        height_m=-0.0004 * gap,
    )

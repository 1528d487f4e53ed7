"""Raw plywood: peeled veneer with its wide growth lines."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.plywood import veneer
from blender_scenes.scene.shading import Mix, Surface, Tiles, paint_color
from configs.schema.appearance.floors import FloorLook


def plywood(look: FloorLook, patch: SurfacePatch) -> Surface:
    """Return sheets side by side, staggered by half, each with different veneer; the seams are open and dark."""
    config = look.plywood
    size, offset = (config.sheet_length_m, config.sheet_width_m), patch.offset("sheets")
    sheet = Tiles(size, config.seam_m, 0.5, offset, "random")
    face, fibres = veneer(patch, config.paint, config.variation, sheet)
    seam = Tiles(size, config.seam_m, 0.5, offset, "joint", softness=0.5)
    # Sawn edges are slightly rounded and hold dirt.
    worn = Tiles(size, config.seam_m + 0.006, 0.5, offset, "joint", softness=1.0)
    face = Mix(0.3 * worn, face, paint_color(config.paint, times=0.5))
    return Surface(
        patch.name,
        Mix(seam, face, paint_color(config.paint, times=0.08)),
        roughness=config.roughness + 0.1 * fibres,
        height_m=0.00003 * fibres - 0.0006 * worn - 0.001 * seam,
    )

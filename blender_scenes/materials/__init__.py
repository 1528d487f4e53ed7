"""Materials, one file each: pure functions from numbers to a `Surface`, and the tables of their names."""

from collections.abc import Callable

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.boards import board
from blender_scenes.materials.brick import brick
from blender_scenes.materials.cardboard import cardboard
from blender_scenes.materials.floors.carpet import carpet
from blender_scenes.materials.floors.ceramic_tile import ceramic_tile
from blender_scenes.materials.floors.concrete import concrete
from blender_scenes.materials.floors.linoleum import linoleum
from blender_scenes.materials.floors.paper_sheets import paper_sheets
from blender_scenes.materials.floors.parquet import parquet
from blender_scenes.materials.floors.vinyl import vinyl
from blender_scenes.materials.glass import glass
from blender_scenes.materials.image import image, image_floor
from blender_scenes.materials.metal import metal
from blender_scenes.materials.paper import paper
from blender_scenes.materials.plastic import plastic
from blender_scenes.materials.plywood import plywood, plywood_floor
from blender_scenes.materials.wood import wood
from blender_scenes.scene.shading import Surface
from configs.schema.appearance.asset import ImageLook
from configs.schema.appearance.floors import FloorLook, FloorName
from configs.schema.appearance.look import LookConfig

FLOORS: dict[FloorName, Callable[[FloorLook, SurfacePatch], Surface]] = {
    "linoleum": linoleum,
    "ceramic_tile": ceramic_tile,
    "parquet": parquet,
    "concrete": concrete,
    "carpet": carpet,
    "plywood": plywood_floor,
    "paper_sheets": paper_sheets,
    "vinyl": vinyl,
    "image": image_floor,
}

SURFACES: dict[str, Callable[[LookConfig, SurfacePatch], Surface]] = {
    "white_board": board(0.78),
    "light_grey_board": board(0.5),
    "dark_grey_board": board(0.16),
    "black_board": board(0.04),
    "metal": metal,
    "wood": wood,
    "plywood": plywood,
    "glass": glass,
    "paper": paper,
    "cardboard": cardboard,
    "plastic": plastic,
    "brick": brick,
}
"""Materials of walls and obstacles, by the names of the arena's surfaces."""


def body_material(look: LookConfig, surface: str, patch: SurfacePatch) -> Surface:
    """Return the material of a face of a wall or obstacle: the user's image where the look has one for that surface."""
    config = getattr(look.images, surface, None)
    if isinstance(config, ImageLook) and config.file is not None:
        return image(config, config.file, patch)
    return SURFACES[surface](look, patch)

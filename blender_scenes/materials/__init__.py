"""Materials, one file each: pure functions from numbers to a `Surface`, and the tables of their names."""

from collections.abc import Callable
from importlib import import_module
from typing import get_args

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.boards import board
from blender_scenes.materials.brick import brick
from blender_scenes.materials.cardboard import cardboard
from blender_scenes.materials.glass import glass
from blender_scenes.materials.image import repeated_image
from blender_scenes.materials.metal import metal
from blender_scenes.materials.paper import paper
from blender_scenes.materials.plastic import plastic
from blender_scenes.materials.plywood import plywood
from blender_scenes.materials.wood import wood
from blender_scenes.scene.shading import Surface
from configs.schema.appearance.asset import ImageLook
from configs.schema.appearance.floors import FloorLook, FloorName
from configs.schema.appearance.look import LookConfig

FLOORS: dict[FloorName, Callable[[FloorLook, SurfacePatch], Surface]] = {
    name: getattr(import_module(f"{__name__}.floors.{name}"), name) for name in get_args(FloorName)
}
"""The function of each floor, which has the name of the floor and is in the module of this name."""

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
        return repeated_image(config, config.file, patch)
    return SURFACES[surface](look, patch)

"""Furniture, one file for each kind: a function that makes a piece from numbers, and one that draws the numbers."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from blender_scenes.rooms.furniture.bag import drawn_bag
from blender_scenes.rooms.furniture.base import Piece
from blender_scenes.rooms.furniture.book_stack import drawn_book_stack
from blender_scenes.rooms.furniture.bottle import drawn_bottle
from blender_scenes.rooms.furniture.cable import drawn_cable
from blender_scenes.rooms.furniture.carton import drawn_carton
from blender_scenes.rooms.furniture.chair import drawn_chair
from blender_scenes.rooms.furniture.office_chair import drawn_office_chair
from blender_scenes.rooms.furniture.sheets import drawn_sheets
from blender_scenes.rooms.furniture.shelf import drawn_shelf
from blender_scenes.rooms.furniture.table import drawn_table
from blender_scenes.rooms.furniture.waste_bin import drawn_waste_bin


@dataclass(frozen=True)
class FurnitureKind:
    """A kind of furniture that stands on the floor, and where people put it; shares are 0 to 1."""

    name: str
    """Name of the kind; its meshes are called `name_0`, `name_1` ..."""
    draw: Callable[[str, np.random.Generator], Piece]
    at_a_wall: float = 0.0
    """Share of the pieces that stand with their back to a wall."""
    at_a_table: float = 0.0
    """Share of the pieces that stand before a table."""
    near_the_arena: float = 0.0
    """Share of the pieces just outside the arena's clearance; the remaining ones stand anywhere."""


STANDING: dict[str, FurnitureKind] = {
    "tables": FurnitureKind("table", drawn_table, at_a_wall=0.4, near_the_arena=0.3),
    "shelves": FurnitureKind("shelf", drawn_shelf, at_a_wall=1.0),
    "chairs": FurnitureKind("chair", drawn_chair, at_a_table=0.7, near_the_arena=0.15),
    "office_chairs": FurnitureKind("office_chair", drawn_office_chair, at_a_table=0.5, near_the_arena=0.25),
    "cartons": FurnitureKind("carton", drawn_carton, at_a_wall=0.4, near_the_arena=0.4),
    "bins": FurnitureKind("waste_bin", drawn_waste_bin, at_a_wall=0.6, near_the_arena=0.2),
    "bags": FurnitureKind("bag", drawn_bag, at_a_wall=0.2, at_a_table=0.2, near_the_arena=0.5),
    "cables": FurnitureKind("cable", drawn_cable, at_a_wall=0.3, near_the_arena=0.6),
    "book_stacks": FurnitureKind("book_stack", drawn_book_stack, at_a_wall=0.2, near_the_arena=0.6),
    "bottles": FurnitureKind("bottle", drawn_bottle, near_the_arena=0.7),
    "sheets": FurnitureKind("sheets", drawn_sheets, near_the_arena=0.7),
}
"""Kinds by the field of `FurnitureLook` that counts them, in the order in which they are placed."""

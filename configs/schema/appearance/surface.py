"""Surfaces of walls and boxes."""

from typing import Literal

SurfaceName = Literal[
    "white_board",
    "light_grey_board",
    "dark_grey_board",
    "black_board",
    "metal",
    "wood",
    "plywood",
    "glass",
    "paper",
    "cardboard",
    "plastic",
    "brick",
]
"""Surface of a wall or obstacle, which determines its range readings (`physics.arena.surfaces`) and its look."""

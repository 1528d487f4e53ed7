"""What walls and boxes are made of."""

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
"""What a wall or obstacle is made of; decides its range reading and its look alike (`physics.arena.surfaces`)."""

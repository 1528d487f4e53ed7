"""The check that images of a trajectory are taken inside the room; wrong units of a log would lead out of it."""

import numpy as np

from blender_scenes.scene.run_scene import floor_bounds
from configs.schema.appearance.look import LookConfig
from pipeline.run_warnings.imported_trajectory import Where
from symolo.arena.geometry import Arena
from symolo.core.errors import InputError
from symolo.dataset.tables.rows import Rows


def check_on_the_floor(rows: Rows, arena: Arena, look: LookConfig, at: Where) -> None:
    """Refuse images from outside the room, where nothing is visible.

    Raises:
        InputError: There is such an image; the first one is named.
    """
    low, high = floor_bounds(arena, look)
    place = rows.pose[:, :2]
    outside = np.flatnonzero((rows.image > 0) & np.any((place < low) | (place > high), axis=1))
    if not len(outside):
        return
    x, y = place[outside[0]].tolist()
    extent = ", ".join(f"{axis} = {a:.2f} to {b:.2f} m" for axis, a, b in zip("xy", low, high, strict=True))
    raise InputError(
        f"x = {x:g}, y = {y:g} m is outside the room, whose floor extends from {extent}",
        where=at(int(outside[0])),
        cure="give x and y in metres, or a different --arena",
    )

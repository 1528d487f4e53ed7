"""Flat lamps below the ceiling, in a grid over the room."""

import math

from blender_scenes.colour import light_rgb, scaled
from blender_scenes.description import Panel
from blender_scenes.lighting.base import Lights
from blender_scenes.rooms.base import Room
from configs.schema.look import LookConfig


def ceiling_lamps(look: LookConfig, room: Room) -> Lights:
    """Lambertian panels: luminance = flux / (pi area)."""
    own = look.lamps
    if own.flux_klm == 0:
        return Lights()
    luminance = own.flux_klm / (math.pi * own.length_m * own.width_m)
    radiance = scaled(light_rgb(own.color_temperature_K), luminance)
    (x0, y0), (x1, y1) = room.low, room.high
    panels = []
    for row in range(own.rows):
        for column in range(own.columns):
            x = x0 + (x1 - x0) * (column + 0.5) / own.columns
            y = y0 + (y1 - y0) * (row + 0.5) / own.rows
            center = (x, y, room.height_m - 0.06)
            panels.append(
                Panel(f"lamp_{row}_{column}", center, (1, 0, 0), (0, -1, 0), own.length_m, own.width_m, radiance)
            )
    return Lights(panels=tuple(panels))

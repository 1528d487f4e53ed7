"""Ceiling lamps in a grid: flat panels, tubes on battens, bulbs in shades."""

import math
from dataclasses import replace

import numpy as np

from blender_scenes.lighting.base import Lights
from blender_scenes.materials.fittings import moulded
from blender_scenes.rooms.base import RoomModel
from blender_scenes.scene.description import LightPanel, Mesh, Point3
from blender_scenes.scene.meshes import block
from blender_scenes.scene.solids import joined, lathe, moved, rod
from configs.schema.appearance.lighting import LampsLook
from configs.schema.appearance.look import LookConfig
from sensors.camera.colour import RGB, light_rgb, scaled

_LOWEST_M = 1.8
_BATTEN_M = 0.05
_MIN_M = 0.02
_APART_M = 0.1
"""Distance between lamps; longer than the part of a housing beyond its tube."""
_SHADE_M = 0.2
"""Height of a shade."""


def ceiling_lamps(look: LookConfig, room: RoomModel) -> Lights:
    """Return Lambertian panels of luminance flux / (pi area), with housings; a lamp that is off has only its housing.

    A lamp is shorter and narrower, with the same flux, where its cell of the grid is too small for it.
    """
    config = look.lamps
    if config.rows * config.columns == 0:
        return Lights()
    length, width = _fitting(config, room)
    luminance = config.flux_klm / (math.pi * length * width)
    radiance: RGB = scaled(light_rgb(config.color_temperature_K), luminance)
    z = max(room.height_m - config.drop_m, min(_LOWEST_M, room.height_m - 0.06))
    (x0, y0), (x1, y1) = room.low, room.high
    panels, meshes = [], []
    for row in range(config.rows):
        for column in range(config.columns):
            x = x0 + (x1 - x0) * (column + 0.5) / config.columns
            y = y0 + (y1 - y0) * (row + 0.5) / config.rows
            name, center = f"lamp_{row}_{column}", (x, y, z)
            if config.flux_klm > 0:
                panels.append(LightPanel(name, center, (1, 0, 0), (0, -1, 0), length, width, radiance, on_mains=True))
            if config.housing != "none":
                body = _batten if config.housing == "batten" else _shade
                meshes.append(body(name, center, (length, width), room.height_m))
    body_surface = replace(moulded("lamp_housing", (0.72, 0.72, 0.7), 0.4), encloses_lamp=config.housing == "shade")
    return Lights(panels=tuple(panels), meshes=tuple(meshes), surfaces=(body_surface,) if meshes else ())


def _fitting(config: LampsLook, room: RoomModel) -> tuple[float, float]:
    """Return length along x and width [m] so that a lamp's housing is clear of the walls and of its neighbours."""
    share = np.maximum(np.subtract(room.high, room.low) / (config.columns, config.rows) - _APART_M, _MIN_M)
    if config.housing == "shade":
        # The configured width is that of the bulb; the rim of the shade is wider.
        side = min(config.width_m, max((float(share.min()) - 1.4 * _SHADE_M) / 1.5, _MIN_M))
        return side, side
    return min(config.length_m, float(share[0])), min(config.width_m, float(share[1]))


def _batten(name: str, lamp: Point3, size_m: tuple[float, float], ceiling_m: float) -> Mesh:
    """Return the sheet metal above the tube, on two rods where it does not touch the ceiling."""
    x, y, z = lamp
    body = (size_m[0] + 0.04, size_m[1] + 0.05, _BATTEN_M)
    parts = [block("batten", (x, y, z + 0.01 + 0.5 * _BATTEN_M), body, "lamp_housing")]
    if ceiling_m - z > 0.1:
        for side in (-0.35 * size_m[0], 0.35 * size_m[0]):
            ends = (x + side, y, z + _BATTEN_M), (x + side, y, ceiling_m)
            parts.append(rod("rod", ends, (0.004, 0.004), "lamp_housing", sides=6))
    return joined(name, parts)


def _shade(name: str, lamp: Point3, size_m: tuple[float, float], ceiling_m: float) -> Mesh:
    """Return a cone that is open below, with the bulb inside, and its cable."""
    x, y, z = lamp
    neck = 0.75 * size_m[0]
    rim = neck + 0.7 * _SHADE_M
    cone = moved(hood(neck, rim, _SHADE_M), (x, y, z - 0.6 * _SHADE_M))
    top = z + 0.4 * _SHADE_M
    cable = rod("cable", ((x, y, top), (x, y, max(ceiling_m, top + 0.01))), (0.004, 0.004), "lamp_housing", sides=6)
    return joined(name, [cone, cable])


def hood(neck_m: float, rim_m: float, height_m: float, surface: str = "lamp_housing") -> Mesh:
    """Return a shade of sheet metal with its open rim in the plane z = 0."""
    thin = 0.002
    outside = [(rim_m, 0.0), (neck_m, height_m), (0.001, height_m)]
    inside = [(0.001, height_m - thin), (neck_m - thin, height_m - thin), (rim_m - thin, 0.0), (rim_m, 0.0)]
    return lathe("hood", [*outside, *inside], surface, closed=False)

"""Coverings of a window: a sheer curtain, or blinds."""

import math

import numpy as np

from blender_scenes.lighting.base import Lights
from blender_scenes.materials.fittings import moulded
from blender_scenes.rooms.base import Opening, RoomModel
from blender_scenes.scene.description import Mesh
from blender_scenes.scene.meshes import box
from blender_scenes.scene.shading import Surface
from blender_scenes.scene.solids import joined
from configs.schema.appearance.look import LookConfig

CURTAIN_M = 0.03
"""Distance outwards from the wall's inner face to a curtain in the window's niche."""
_SLAT_M = 0.05
_PITCH_M = 0.044
_THIN_M = 0.0008
_BLINDS_M = 0.045
"""Distance outwards from the wall's inner face to the middle of the slats."""


def curtain(window: Opening) -> tuple[tuple[Mesh, ...], tuple[Surface, ...]]:
    """Return a white cloth that fills the niche just behind the panel with its light."""
    cloth = _board("curtain", window, (0.0, CURTAIN_M + 0.01), (window.height_m, 0.002), 0.0)
    return (cloth,), (moulded("window_covering", (0.75, 0.75, 0.73), 0.9),)


def blinds(look: LookConfig, room: RoomModel) -> Lights:
    """Return tilted slats across the window; nothing for another covering."""
    if look.window.covering != "blinds":
        return Lights()
    window, tilt = room.window, math.radians(look.window.slat_tilt_deg)
    count = int(window.height_m / _PITCH_M)
    heights = (np.arange(count) - 0.5 * (count - 1)) * _PITCH_M
    slats = [_board("slat", window, (float(h), _BLINDS_M), (_THIN_M, _SLAT_M), tilt) for h in heights]
    return Lights(meshes=(joined("blinds", slats),), surfaces=(moulded("window_covering", (0.7, 0.7, 0.68), 0.4),))


def _board(name: str, window: Opening, at: tuple[float, float], size: tuple[float, float], tilt_rad: float) -> Mesh:
    """Return a board as wide as the window, `at` a height above its middle and a distance outwards.

    `size` is its height and its depth; the tilt lifts the outer edge.
    """
    right, up, inward = np.array(window.right), np.array(window.up), np.array(window.inward)
    height, outwards = at
    middle = np.array(window.center) + up * height - inward * outwards
    deep = (-inward * math.cos(tilt_rad) + up * math.sin(tilt_rad)) * 0.5 * size[1]
    thick = (up * math.cos(tilt_rad) + inward * math.sin(tilt_rad)) * 0.5 * size[0]
    half = right * (0.5 * window.width_m - 0.002)
    lower = [middle - half - deep, middle + half - deep, middle + half + deep, middle - half + deep]
    corners = np.concatenate([np.array(lower) - thick, np.array(lower) + thick])
    return box(name, corners, ("window_covering",) * 6)

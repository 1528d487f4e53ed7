"""Sheets of paper on the floor beneath the line, as people lay them before they tape a line on a floor of one grey."""

from dataclasses import replace
from math import atan2, ceil, radians

import numpy as np

from blender_scenes.scene.description import Mesh
from configs.schema.appearance.look import LineSheetsLook
from symolo.arena.geometry import Line
from symolo.core.arrays import Array
from symolo.core.random_streams import stream

_HEIGHTS_M = tuple(4e-6 + 5e-7 * k for k in range(8))
"""Heights of the sheets, in turn. All are below the thinnest line, which is 10 um thick, so that it need not move."""
_MAX_TURN_RAD = radians(1.5)


def with_sheets(floor: Mesh, line: Line, look: LineSheetsLook, surface: str, seed: int) -> Mesh:
    """Return the floor with sheets along the line: faces of the floor's mesh, so that labels show them as floor.

    Each sheet is a rectangle across the line's course at its middle, shifted and turned a little. The surface
    coordinates of its own material run along its sides.
    """
    vertices, faces, uv, surfaces = list(floor.vertices), list(floor.faces), list(floor.uv_m), list(floor.face_surface)
    for number, (middle, heading) in enumerate(_places(line, look.length_m)):
        draw = stream(seed, "sheet beneath the line", number)
        shift_m, turn, at_u, at_v = look.shift_m * draw.uniform(-1, 1), draw.uniform(-1, 1), *draw.uniform(0, 10, 2)
        along = np.array([np.cos(heading + turn * _MAX_TURN_RAD), np.sin(heading + turn * _MAX_TURN_RAD)])
        left = np.array([-along[1], along[0]])
        half = 0.5 * look.length_m * along, 0.5 * look.width_m * left
        corners = [middle + shift_m * left + a * half[0] + b * half[1] for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        first, z = len(vertices), _HEIGHTS_M[number % len(_HEIGHTS_M)]
        vertices += [(float(x), float(y), z) for x, y in corners]
        faces.append((first, first + 1, first + 2, first + 3))
        u, v = at_u + look.length_m, at_v + look.width_m
        uv.append(((at_u, at_v), (u, at_v), (u, v), (at_u, v)))
        surfaces.append(surface)
    return replace(floor, vertices=tuple(vertices), faces=tuple(faces), uv_m=tuple(uv), face_surface=tuple(surfaces))


def _places(line: Line, length_m: float) -> list[tuple[Array, float]]:
    """Return middle (2,) and heading [rad] of the sheets that cover each strip from end to end."""
    places = []
    for strip in line.strips:
        count = max(1, ceil(strip.length_m / length_m))
        at = (np.arange(count) + 0.5) * strip.length_m / count
        for before, middle, after in zip(strip.at(at - 1e-4), strip.at(at), strip.at(at + 1e-4), strict=True):
            dx, dy = after - before
            places.append((middle, atan2(dy, dx)))
    return places

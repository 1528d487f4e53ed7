"""Lights whose shadows have wide borders: lamps of any size, and the light that other surfaces reflect.

A point of a light is homogeneous, as in `small_lights`.
"""

import numpy as np
from numpy.typing import NDArray

from blender_scenes.scene.description import LightPanel
from symolo.core.arrays import Array

_ALONG = 32
"""Number of pieces along a side of a lamp."""
_GOLDEN = 0.5 * (5.0**0.5 - 1.0)
_MAX_SINE = 0.995
"""Sine of the largest angle from the vertical of light from all sides; below it, shadows are very long."""


def lattice(count: int) -> tuple[Array, Array]:
    """Return two coordinates (K,) of points all over a square, of which no two share one.

    In a grid, all points of a line would move a shadow's border at once, so that it would have few steps.
    """
    numbers = np.arange(count)
    return (numbers + 0.5) / count, (numbers * _GOLDEN + 0.5) % 1.0


def even_directions(count: int) -> Array:
    """Return points (K, 4) of light from all sides, with equal parts of the light on a level floor."""
    share, turn = lattice(count)
    # The light from within an angle of the vertical is the square of its sine.
    sine = _MAX_SINE * np.sqrt(share)
    angle = 2 * np.pi * turn
    return np.column_stack([sine * np.cos(angle), sine * np.sin(angle), np.sqrt(1 - sine**2), np.zeros(count)])


class WideLamp:
    """The light of a lamp on the level floor around a point."""

    def __init__(self, panel: LightPanel, floor_at: Array, above_m: float) -> None:
        """Take a point (3,) of the floor, and a height; what of the lamp is below it is left out."""
        self.name, self._panel = panel.name, panel
        pieces = (np.arange(_ALONG) + 0.5) / _ALONG - 0.5
        places = self._places(*np.meshgrid(pieces, pieces))
        away = places - floor_at
        cosines = np.maximum(-(away @ np.cross(panel.right, panel.up)), 0) * np.maximum(away[..., 2], 0)
        # Points are all over a piece, and one below what moves would throw its shadow to the other side.
        half_rise_m = 0.5 / _ALONG * (panel.width_m * abs(panel.right[2]) + panel.height_m * abs(panel.up[2]))
        is_above = places[..., 2] - half_rise_m > above_m
        light = np.where(is_above, cosines / (away**2).sum(axis=-1) ** 2, 0)
        self._by_piece = light
        area_m2 = panel.width_m * panel.height_m
        self.light: Array = np.array(panel.radiance) * area_m2 * light.mean() / np.pi
        """Light (3,) of a matt white floor there."""

    def points(self, count: int) -> Array:
        """Return points (K, 4) in W with equal parts of the light; none if there is no light."""
        if not self._by_piece.any():
            return np.zeros((0, 4))
        across, along = lattice(count)
        row, up = _inverse(self._by_piece.sum(axis=1)[None], across)
        _, right = _inverse(self._by_piece[row], along)
        return np.column_stack([self._places(right, up), np.ones(count)])

    def _places(self, right: Array, up: Array) -> Array:
        """Return the places (..., 3) of points of the lamp, whose sides are from -0.5 to 0.5."""
        panel = self._panel
        along = panel.width_m * right[..., None] * np.array(panel.right)
        return panel.center + along + panel.height_m * up[..., None] * np.array(panel.up)


def _inverse(parts: Array, share: Array) -> tuple[NDArray[np.int64], Array]:
    """Return the piece (K,) in which sums over parts (K or 1, N) reach a share (K,) of all, and where, -0.5 to 0.5."""
    sums = parts.cumsum(axis=1)
    targets = share[:, None] * sums[:, -1:]
    piece = np.minimum((sums <= targets).sum(axis=1), parts.shape[1] - 1)
    rows = np.arange(len(share)) if len(parts) > 1 else np.zeros(len(share), int)
    within = 1 - (sums[rows, piece] - targets[:, 0]) / parts[rows, piece]
    return piece, (piece + within) / parts.shape[1] - 0.5

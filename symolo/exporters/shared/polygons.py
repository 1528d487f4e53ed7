"""Polygons of masks, for formats that describe an object by a single closed polygon."""

from typing import Any

import numpy as np
from contourpy import FillType, contour_generator
from numpy.typing import NDArray

from symolo.core.arrays import Array


def polygon_of(mask: NDArray[np.bool_]) -> Array:
    """Return one closed polygon around the True pixels of a mask (H, W): x, y [px], (vertices, 2), the last is open.

    Pixel (row, column) is the square from (column, row) to (column + 1, row + 1). The outline runs through the middles
    of the sides between True and False pixels, so it cuts off corners, and exactly the centres of the True pixels are
    inside. Parts, and the edges of holes, are joined by pairs of coincident lines, which enclose no area.
    """
    padded = np.pad(mask, 1).astype(np.float64)
    centres = np.arange(-0.5, max(padded.shape))
    height, width = padded.shape
    outlines = contour_generator(centres[:width], centres[:height], padded, fill_type=FillType.OuterOffset)
    filled: Any = outlines.filled(0.5, np.inf)  # its type depends on the type of filling
    points, offsets = filled
    rings = [
        _without_straight(ring[start : end - 1])  # the last point of a ring repeats the first one
        for ring, ends in zip(points, offsets, strict=True)
        for start, end in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True)
    ]
    polygon = rings[0]
    for ring in sorted(rings[1:], key=lambda ring: float(np.abs(ring - polygon[0]).sum(axis=1).min())):
        polygon = _joined(polygon, ring)
    return polygon


def _without_straight(ring: Array) -> Array:
    """Return a closed ring (N, 2) without the points on the straight line between their neighbours."""
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    return ring[np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]) > 1e-9]


def _joined(polygon: Array, ring: Array) -> Array:
    """Return the polygon with a detour to the ring, once around it, and back, between the two nearest vertices."""
    squared = ((polygon[:, None, :] - ring[None, :, :]) ** 2).sum(axis=2)
    i, j = np.unravel_index(int(np.argmin(squared)), squared.shape)
    around = np.concatenate((ring[j:], ring[: j + 1]))
    return np.concatenate((polygon[: i + 1], around, polygon[i:]))

"""Edges of a line at half of its step in linear light.

A lens blurs light, not grey values. The edge of a blurred line is where the light is halfway between line and floor,
whatever the blur; half of the grey values, which the tone curve has bent, lies off the edge on the side of the line if
the line is dark, and on that of the floor if it is light.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.stats import theilslopes

from diagnosis.photographs.line_place import LinePlace
from sensors.camera.colour import LUMINANCE
from sensors.camera.response import inverse_tone
from symolo.core.arrays import Array

_ROWS = 120
"""Number of rows, evenly spread, in which the edges are measured."""
_MIN_ROWS = 5
"""Smallest number of rows with both edges; with fewer, the place remains as it is."""
_BEYOND_PX, _FLOOR_PX = 5, 12
"""Distances from an edge between which the floor beside it has its level."""
_SEARCH_PX = 8.0
"""Largest distance of an edge from the place that thresholds give."""
_LINE_SHARE = 0.35
"""Share of the line's width, in its middle, that has the level of the line."""


def with_light_edges(place: LinePlace, contrast: float) -> LinePlace:
    """Return a place whose widths are those between the edges in linear light.

    Args:
        place: Place of the line by thresholds, up to some pixels.
        contrast: Contrast of the camera, with which its grey values become light.
    """
    rgb = place.image[..., ::-1].astype(np.float64) / 255
    light = inverse_tone(rgb, contrast) @ LUMINANCE
    rows = np.unique(np.linspace(place.rows_px[0], place.rows_px[-1], _ROWS).astype(int))
    left, right = place.edges_px(rows)
    measured = [
        (row, width)
        for row, low, high in zip(rows.tolist(), left.tolist(), right.tolist(), strict=True)
        if (width := _width_px(light[row] if place.is_dark else -light[row], low, high)) is not None
    ]
    if len(measured) < _MIN_ROWS:
        return place
    at, widths = (np.array(each, np.float64) for each in zip(*measured, strict=True))
    taper, at_zero, *_ = theilslopes(widths, at)
    widths_px = at_zero + taper * np.array([row - 0.5 for row in place.rows_px])
    return replace(place, width_px=float(np.median(widths)), widths_px=widths_px)


def _width_px(profile: Array, left: float, right: float) -> float | None:
    """Return the width of a dark line in a row (W,); None if an edge or the floor beside it is not clear.

    Args:
        profile: Light along the row.
        left: Place of its left edge by thresholds.
        right: Place of its right edge.
    """
    middle, half = 0.5 * (left + right), 0.5 * _LINE_SHARE * (right - left)
    inner = profile[max(0, round(middle - half)) : round(middle + half) + 1]
    if not len(inner):
        return None
    line, start = float(np.median(inner)), round(middle)
    edges = [
        _crossing_px(outward, line, abs(edge - start))
        for outward, edge in ((profile[start::-1], left), (profile[start:], right))
    ]
    return None if None in edges else float(sum(edge for edge in edges if edge is not None))


def _crossing_px(outward: Array, line: float, expected_px: float) -> float | None:
    """Return how far from its first sample a profile rises halfway to the floor; None if it is not clear."""
    first = round(expected_px)
    beside = outward[first + _BEYOND_PX : first + _FLOOR_PX]
    if len(beside) < _FLOOR_PX - _BEYOND_PX:
        return None
    level = 0.5 * (line + float(np.median(beside)))
    crossings = [at for at in _rises(outward, level) if abs(at - expected_px) < _SEARCH_PX]
    return min(crossings, key=lambda at: abs(at - expected_px), default=None)


def _rises(profile: Array, level: float) -> Iterator[float]:
    """Yield where a profile rises through a level, between its samples."""
    for at in np.flatnonzero((profile[:-1] <= level) & (profile[1:] > level)).tolist():
        yield at + float((level - profile[at]) / (profile[at + 1] - profile[at]))

"""Drawn numbers as marks on a line, above the range of their distribution: a plot in the cell of a table."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from symolo.core.distributions import Choice, Distribution, LogUniform, Normal, Uniform
from symolo.core.progress import plural

_WIDTH, _HEIGHT, _MARGIN = 220, 20, 5.0
_FOOT = _HEIGHT - 6.0
"""y [px] where the marks end and the band of the distribution begins."""
MAX_MARKS = 60
"""More values are shown as the bars of a histogram."""
_BINS = 24


@dataclass(frozen=True)
class SvgRectangle:
    """One rectangle of an SVG plot, in pixels; `kind` is `axis`, `band` or `mark`."""

    x: float
    y: float
    width: float
    height: float
    kind: str


@dataclass(frozen=True)
class Strip:
    """The plot of one field."""

    title: str
    rectangles: tuple[SvgRectangle, ...]
    width_px: int = _WIDTH
    height_px: int = _HEIGHT


def strip(values: Sequence[float], distribution: Distribution | None) -> Strip:
    """Return the plot of the values of a field.

    Args:
        values: At least one.
        distribution: Its range is the grey band, 2 sd to each side of the mean for a normal one; the axis of a
            log-uniform one is logarithmic.
    """
    band = _band(distribution)
    scaled = math.log if isinstance(distribution, LogUniform) else float
    ends = [scaled(value) for value in (*values, *band)]
    low, high = min(ends), max(ends)

    def at(value: float) -> float:
        share = (scaled(value) - low) / (high - low) if high > low else 0.5
        return _MARGIN + (_WIDTH - 2 * _MARGIN) * share

    parts = [SvgRectangle(_MARGIN, _FOOT + 2, _WIDTH - 2 * _MARGIN, 1, "axis")]
    if isinstance(distribution, Choice):
        parts += [SvgRectangle(at(option) - 2, _FOOT, 4, 5, "band") for option in band]
    elif band:
        parts.append(SvgRectangle(at(band[0]), _FOOT, max(at(band[-1]) - at(band[0]), 2.0), 5, "band"))
    if len(values) <= MAX_MARKS:
        parts += [SvgRectangle(at(value) - 1, 2, 2, _FOOT - 3, "mark") for value in sorted(values)]
    else:
        parts += _bars([at(value) for value in values])
    return Strip(f"{plural(len(values), 'value')} from {min(values):.4g} to {max(values):.4g}", tuple(parts))


def _band(distribution: Distribution | None) -> tuple[float, ...]:
    """Return the ends of a range, or the options of a choice that are numbers."""
    match distribution:
        case Uniform(low, high) | LogUniform(low, high):
            return (low, high)
        case Normal(mean, sd):
            minimum, maximum = (float(end) for end in distribution.extremes())
            return (max(mean - 2 * sd, minimum), min(mean + 2 * sd, maximum))
        case Choice(options):
            return tuple(sorted(float(o) for o in options if isinstance(o, int | float) and not isinstance(o, bool)))
        case None:
            return ()


def _bars(places: Sequence[float]) -> list[SvgRectangle]:
    width = (_WIDTH - 2 * _MARGIN) / _BINS
    counts = [0] * _BINS
    for place in places:
        counts[min(int((place - _MARGIN) / width), _BINS - 1)] += 1
    heights = [(_FOOT - 2) * count / max(counts) for count in counts]
    return [
        SvgRectangle(_MARGIN + i * width, _FOOT - 1 - height, 0.9 * width, height, "mark")
        for i, height in enumerate(heights)
        if height
    ]

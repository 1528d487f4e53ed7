"""Drawn numbers as marks on a line, above the range that was asked for: a picture of a table's cell."""

import math
from collections.abc import Sequence

from symolo.core.distributions import Choice, Distribution, LogUniform, Normal, Uniform
from symolo.pages.markup import Html, tag

_WIDTH, _HEIGHT, _MARGIN = 220.0, 20.0, 5.0
_FOOT = _HEIGHT - 6
"""Where the marks end and what was asked for begins."""
MAX_MARKS = 60
"""Of more values, bars of a histogram."""
_BINS = 24


def in_words(asked: Distribution | None) -> str:
    """As a scenario says it."""
    match asked:
        case Uniform(low, high):
            return f"uniform {low:g} to {high:g}"
        case LogUniform(low, high):
            return f"log-uniform {low:g} to {high:g}"
        case Normal(mean, sd, low, high):
            least, most = asked.extremes()
            cut = "" if low is None and high is None else f", cut at {least:g} and {most:g}"
            return f"normal {mean:g}, sd {sd:g}{cut}"
        case Choice(options):
            told = ", ".join(str(option) for option in options[:8])
            return f"choice of {told}" + (f" and {len(options) - 8} more" if len(options) > 8 else "")
        case None:
            return ""


def strip(values: Sequence[float], asked: Distribution | None) -> Html:
    """As inline SVG.

    Args:
        values: At least one.
        asked: Its ends are those of the grey band, 2 sd to each side of a normal one; the axis of a log-uniform one
            is logarithmic.
    """
    band = _band(asked)
    scaled = math.log if isinstance(asked, LogUniform) else float
    ends = [scaled(value) for value in (*values, *band)]
    low, high = min(ends), max(ends)

    def at(value: float) -> float:
        share = (scaled(value) - low) / (high - low) if high > low else 0.5
        return _MARGIN + (_WIDTH - 2 * _MARGIN) * share

    parts = [_rect(_MARGIN, _FOOT + 2, _WIDTH - 2 * _MARGIN, 1, "axis")]
    if isinstance(asked, Choice):
        parts += [_rect(at(option) - 2, _FOOT, 4, 5, "band") for option in band]
    elif band:
        parts.append(_rect(at(band[0]), _FOOT, max(at(band[-1]) - at(band[0]), 2.0), 5, "band"))
    if len(values) <= MAX_MARKS:
        parts += [_rect(at(value) - 1, 2, 2, _FOOT - 3, "mark") for value in sorted(values)]
    else:
        parts += _bars([at(value) for value in values])
    about = f"{len(values)} values from {min(values):.4g} to {max(values):.4g}"
    size = {"viewBox": f"0 0 {_WIDTH:g} {_HEIGHT:g}", "width": f"{_WIDTH:g}", "height": f"{_HEIGHT:g}"}
    return tag("svg", tag("title", about), parts, class_="strip", role="img", **size)


def _band(asked: Distribution | None) -> tuple[float, ...]:
    """Ends of a range, or the options of a choice."""
    match asked:
        case Uniform(low, high) | LogUniform(low, high):
            return (low, high)
        case Normal(mean, sd):
            ends = [float(end) for end in asked.extremes()]
            return (max(mean - 2 * sd, ends[0]), min(mean + 2 * sd, ends[1]))
        case Choice(options):
            numbers = sorted(float(o) for o in options if isinstance(o, int | float) and not isinstance(o, bool))
            return tuple(numbers)
        case None:
            return ()


def _bars(places: Sequence[float]) -> list[Html]:
    width = (_WIDTH - 2 * _MARGIN) / _BINS
    counts = [0] * _BINS
    for place in places:
        counts[min(int((place - _MARGIN) / width), _BINS - 1)] += 1
    heights = [(_FOOT - 2) * count / max(counts) for count in counts]
    return [
        _rect(_MARGIN + i * width, _FOOT - 1 - height, 0.9 * width, height, "mark")
        for i, height in enumerate(heights)
        if height
    ]


def _rect(x: float, y: float, width: float, height: float, kind: str) -> Html:
    return tag("rect", x=f"{x:.1f}", y=f"{y:.1f}", width=f"{width:.1f}", height=f"{height:.1f}", class_=kind)

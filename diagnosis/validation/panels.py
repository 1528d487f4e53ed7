"""Panels of a figure as data, and the one layout that draws them."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from symolo.pages.plotting import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, finished, png

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLORS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, GREY, BLACK)
DASHES = ("-", "--", "-.", ":", "-", "--", "-.", ":")
MARKERS = ("o", "s", "^", "v", "D", "P", "X", "*")
"""Colours, dashes and markers of numbered curves."""
COLUMNS = 3
PANEL_SIZE_IN = (5.8, 4.6)


@dataclass(frozen=True)
class Curve:
    """Points, a line, bars or an area in a panel."""

    x: ArrayLike
    """(N,), horizontal coordinates."""
    y: ArrayLike
    """(N,), vertical coordinates."""
    label: str = ""
    color: str = BLUE
    style: str = "-"
    """Marker and dashes as matplotlib writes them."""
    width: float = 1.5
    """Width of the line [points]."""
    size: float = 5.0
    """Size of the markers [points]."""
    kind: Literal["line", "bars", "area"] = "line"
    base: ArrayLike = 0.0
    """Lower end of bars and areas, (N,) or one value."""


@dataclass(frozen=True)
class Panel:
    """One plot with its axes."""

    title: str
    x_label: str
    y_label: str
    curves: Sequence[Curve]
    x_lines: Sequence[float] = ()
    """Positions of vertical grey lines, such as a closed form."""
    y_lines: Sequence[float] = ()
    """Positions of horizontal grey lines."""
    x_range: tuple[float, float] | None = None
    y_range: tuple[float | None, float | None] = (None, None)
    """Lower and upper end; None for an end that follows from the curves."""
    x_names: Sequence[str] = field(default=())
    """Names at x = 0, 1, ... instead of numbers."""
    is_logarithmic: bool = False


def figure(title: str, panels: Sequence[Panel]) -> bytes:
    """Return a PNG with the panels in rows."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - takes half a second, and importers of logs load this module

    columns = min(COLUMNS, max(1, len(panels)))
    rows = max(1, -(-len(panels) // columns))
    drawn = Figure(figsize=(PANEL_SIZE_IN[0] * columns, PANEL_SIZE_IN[1] * rows), layout="constrained")
    drawn.suptitle(_literal(title))
    for place, panel in enumerate(panels, start=1):
        _draw(drawn.add_subplot(rows, columns, place), panel)
    return png(drawn)


def _draw(axes: "Axes", panel: Panel) -> None:
    axes.use_sticky_edges = False  # else a bar's lower end lies on the frame
    for place in panel.x_lines:
        axes.axvline(place, color=GREY, ls="--", lw=1)
    for place in panel.y_lines:
        axes.axhline(place, color=GREY, ls="--", lw=1)
    for curve in panel.curves:
        _draw_curve(axes, curve)
    if panel.is_logarithmic:
        axes.set(xscale="log", yscale="log")
    if panel.x_names:
        axes.set_xticks(range(len(panel.x_names)), list(panel.x_names), rotation=35, ha="right", rotation_mode="anchor")
    axes.set_xlim(panel.x_range)
    axes.set_ylim(*panel.y_range)
    legend = any(curve.label for curve in panel.curves)
    finished(axes, _literal(panel.title), panel.x_label, panel.y_label, legend=legend)


def _draw_curve(axes: "Axes", curve: Curve) -> None:
    label = _literal(curve.label) or None
    if curve.kind == "area":
        axes.fill_between(np.asarray(curve.x), np.asarray(curve.y), curve.base, color=curve.color, label=label, lw=0)
    elif curve.kind == "bars":
        places = np.asarray(curve.x, np.float64)
        width = 0.8 * float(np.diff(places).min()) if len(places) > 1 else 0.8
        heights = np.asarray(curve.y) - np.asarray(curve.base)
        axes.bar(places, heights, width, bottom=curve.base, color=curve.color, label=label)
    else:
        axes.plot(
            np.asarray(curve.x),
            np.asarray(curve.y),
            curve.style,
            color=curve.color,
            label=label,
            lw=curve.width,
            ms=curve.size,
            mfc="none",
            mew=1.2,
        )


def _literal(text: str) -> str:
    """Return the text with escaped dollar signs, since those in the name of a file do not begin a formula."""
    return text.replace("$", r"\$")

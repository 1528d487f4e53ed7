"""Plots of the grey values, and of the spread of brightness, clipping and sharpness over the images of each run."""

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from symolo.core.arrays import Array
from symolo.dataset.brightness import BLACK_UP_TO, BURNT_FROM
from symolo.dataset.tables.rows import Ints
from symolo.pages.plotting import BLACK, BLUE, GREEN, GREY, ORANGE, PALE, PURPLE, SKY, VERMILION, finished, svg
from symolo.report.statistics.image_statistics import GREYS, ImageNumbers

MAX_CURVES = 8
"""Largest number of runs with a curve each; if there are more, each route has one curve."""
_BIN = 4
_LINES = (
    (BLACK, "-"),
    (BLUE, (0, (4.0, 1.5))),
    (VERMILION, "-"),
    (GREEN, (0, (1.0, 1.0))),
    (ORANGE, (0, (5.0, 1.2, 1.0, 1.2))),
    (PURPLE, (0, (4.0, 1.5))),
    (SKY, "-"),
    (GREY, (0, (1.0, 1.0))),
)


def brightness_plot(runs: Sequence[ImageNumbers]) -> bytes:
    """Return histograms of the grey values of all pixels as SVG; `runs` has at least one run, and each has an image."""
    figure = Figure(figsize=(7.0, 3.2), layout="constrained")
    axes = figure.subplots()
    for (name, pixels), (colour, dash) in zip(_curves(runs), cycle(_LINES), strict=False):
        share = 100 * pixels.reshape(-1, _BIN).sum(axis=1) / max(int(pixels.sum()), 1)
        edges = np.arange(0, GREYS + 1, _BIN)
        axes.stairs(share, edges, color=colour, linestyle=dash, linewidth=1.2, label=name)
    for value in (BLACK_UP_TO + 0.5, BURNT_FROM - 0.5):
        axes.axvline(value, color=GREY, linewidth=0.8, linestyle=(0, (2.0, 2.0)))
    axes.set(xlim=(0, GREYS), xticks=range(0, GREYS + 1, 32))
    axes.set_ylim(bottom=0.0)
    finished(axes, "", "grey value", f"pixels [%], bins of {_BIN}", legend=False)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize="small", frameon=False)
    return svg(figure)


def _curves(runs: Sequence[ImageNumbers]) -> list[tuple[str, Ints]]:
    if len(runs) <= MAX_CURVES:
        return [(run.run, run.pixels) for run in runs]
    routes: dict[str, Ints] = {}
    for run in runs:
        route = run.run.partition("/")[0]
        routes[route] = routes.get(route, np.zeros(GREYS, np.int64)) + run.pixels
    return list(routes.items())


def spread_plot(runs: Sequence[ImageNumbers]) -> bytes:
    """Return a plot with a row for each run as SVG; each run has an image."""
    columns = (
        ("brightness\n[mean grey value]", [run.brightness for run in runs]),
        ("black or overexposed\n[% of pixels]", [100 * (run.black + run.burnt) for run in runs]),
        ("sharpness\n[sd of the Laplacian]", [run.sharpness for run in runs]),
    )
    figure = Figure(figsize=(7.0, 1.1 + 0.27 * max(len(runs), 4)), layout="constrained")
    panels = figure.subplots(1, len(columns), sharey=True)
    for axes, (label, values) in zip(panels, columns, strict=True):
        for row, run_values in enumerate(values):
            _row(axes, row, run_values)
        axes.set_xlabel(label)
        axes.grid(alpha=0.3, axis="x")
    panels[0].set_yticks(range(len(runs)), [run.run for run in runs], fontsize="small")
    panels[0].set_ylim(len(runs) - 0.5, -0.5)
    panels[1].set_xlim(left=min(0.0, panels[1].get_xlim()[0]))
    return svg(figure)


def _row(axes: Axes, row: int, values: Array) -> None:
    """Draw the whole range, the middle half and the median."""
    low, lower, middle, upper, high = np.percentile(values, (0, 25, 50, 75, 100)).tolist()
    axes.plot((low, high), (row, row), "|-", color=BLACK, linewidth=0.8, markersize=5)
    axes.barh(row, max(upper - lower, 0.0), 0.5, left=lower, color=PALE, edgecolor=BLACK, linewidth=0.8, zorder=3)
    axes.plot(middle, row, "D", color=BLUE, markersize=4, zorder=4)

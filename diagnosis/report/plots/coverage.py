"""Distributions of a measured drive and of a dataset, quantity by quantity."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from diagnosis.against import Against
from diagnosis.report.plots.panels import MEASURED
from diagnosis.report.quantities import axis
from symolo.core.arrays import Array
from symolo.pages.plotting import BLUE, PALE, finished, png

ACROSS = 5
MAX_CURVES = 40
POINTS = 300


def against_picture(found: Against) -> bytes:
    """As PNG."""
    down = -(-len(found.seen) // ACROSS)
    figure = Figure(figsize=(2.6 * ACROSS, 2.5 * down), layout="constrained")
    panels = figure.subplots(down, ACROSS, squeeze=False, sharey=True).ravel()
    for axes, of in zip(panels, found.seen, strict=False):
        for k, run in enumerate(of.runs[:MAX_CURVES]):
            _curve(axes, run, color=PALE, linewidth=0.9, label="_" if k else "its runs")
        _curve(axes, of.pooled, color=BLUE, linewidth=1.4, label="dataset")
        _curve(axes, of.measured, color=MEASURED, linewidth=1.4, label="measured")
        words, _, unit = axis(of.name).partition(" [")
        finished(axes, words, f"[{unit}" if unit else "", "", legend=axes is panels[0])
    for axes in panels[len(found.seen) :]:
        axes.set_axis_off()
    for row in panels[::ACROSS]:
        row.set_ylabel("share below")
    return png(figure)


def _curve(axes: Axes, values: Array, **style: object) -> None:
    shares = np.linspace(0.0, 1.0, POINTS)
    axes.plot(np.quantile(values, shares), shares, **style)  # pyright: ignore[reportArgumentType]

"""Distributions of a measured drive and of a dataset, quantity by quantity."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from diagnosis.dataset_comparison import DatasetComparison
from diagnosis.report.plots.panels import MEASURED
from diagnosis.report.sentences.quantities import axis
from symolo.core.arrays import Array
from symolo.pages.plotting import BLUE, PALE, finished, png

COLUMNS = 5
MAX_CURVES = 40
POINTS = 300


def coverage_plot(comparison: DatasetComparison) -> bytes:
    """Return the plot as PNG."""
    rows = -(-len(comparison.signals) // COLUMNS)
    figure = Figure(figsize=(2.6 * COLUMNS, 2.5 * rows), layout="constrained")
    panels = figure.subplots(rows, COLUMNS, squeeze=False, sharey=True).ravel()
    for axes, signal in zip(panels, comparison.signals, strict=False):
        for k, run in enumerate(signal.runs[:MAX_CURVES]):
            _curve(axes, run, color=PALE, linewidth=0.9, label="_" if k else "its runs")
        _curve(axes, signal.pooled, color=BLUE, linewidth=1.4, label="dataset")
        _curve(axes, signal.measured, color=MEASURED, linewidth=1.4, label="measured")
        words, _, unit = axis(signal.name).partition(" [")
        finished(axes, words, f"[{unit}" if unit else "", "", legend=axes is panels[0])
    for axes in panels[len(comparison.signals) :]:
        axes.set_axis_off()
    for axes in panels[::COLUMNS]:
        axes.set_ylabel("share below")
    return png(figure)


def _curve(axes: Axes, values: Array, **style: object) -> None:
    shares = np.linspace(0.0, 1.0, POINTS)
    axes.plot(np.quantile(values, shares), shares, **style)  # pyright: ignore[reportArgumentType]

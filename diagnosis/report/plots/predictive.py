"""Plot of the posterior predictive check: the measured statistics among those of the drawn robots."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from diagnosis.posterior.predictive_check import STATISTICS, CheckedStatistic
from diagnosis.report.plots.panels import MEASURED
from symolo.pages.plotting import PALE, VERMILION, finished, png, set_margins, width_of_labels_in

IN_SD = ("median", "half width of the middle 68 %")
"""Statistics with a unit."""


def predictive_plot(checks: Sequence[CheckedStatistic]) -> bytes:
    """Return the plot as PNG, with a panel for each statistic and a row for each quantity."""
    labels = list(dict.fromkeys(f"{each.quantity}, {each.rows}" for each in checks))
    names = [name for name in STATISTICS if any(each.name == name for each in checks)]
    left_in = width_of_labels_in(labels)
    figure = Figure(figsize=(left_in + 2.2 * len(names), 1.0 + 0.3 * len(labels)))
    set_margins(figure, len(names), left_in=left_in, bottom_in=0.5, top_in=0.3, between_in=0.15)
    panels = figure.subplots(1, len(names), squeeze=False, sharey=True).ravel()
    for axes, name in zip(panels, names, strict=True):
        shown = [each for each in checks if each.name == name]
        rows = np.array([labels.index(f"{each.quantity}, {each.rows}") for each in shown])
        low, middle, high = np.array([each.quantiles for each in shown]).T
        # One artist for all rows takes a fraction of the time of one for each.
        axes.hlines(rows, low, high, color=PALE, linewidth=7, zorder=1)
        axes.plot(middle, rows, "|", color="white", markersize=9, zorder=2)
        measured, is_outside = (np.array([getattr(each, key) for each in shown]) for key in ("measured", "is_outside"))
        for some, marker, colour in ((~is_outside, "o", MEASURED), (is_outside, "x", VERMILION)):
            axes.plot(measured[some], rows[some], marker, color=colour, markersize=5, zorder=3)
        finished(axes, name, "[sd of the noise]" if name in IN_SD else "", "", legend=False)
    panels[0].set_yticks(np.arange(len(labels)).tolist(), labels, fontsize="small")
    panels[0].set_ylim(len(labels) - 0.5, -0.5)
    return png(figure)

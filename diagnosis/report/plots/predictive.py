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
        for each in (each for each in checks if each.name == name):
            row = labels.index(f"{each.quantity}, {each.rows}")
            low, middle, high = each.quantiles
            axes.plot([low, high], [row, row], color=PALE, linewidth=7, solid_capstyle="butt", zorder=1)
            axes.plot([middle], [row], "|", color="white", markersize=9, zorder=2)
            colour = VERMILION if each.is_outside else MEASURED
            axes.plot([each.measured], [row], "x" if each.is_outside else "o", color=colour, markersize=5, zorder=3)
        finished(axes, name, "[sd of the noise]" if name in IN_SD else "", "", legend=False)
    panels[0].set_yticks(np.arange(len(labels)).tolist(), labels, fontsize="small")
    panels[0].set_ylim(len(labels) - 0.5, -0.5)
    return png(figure)

"""Plot of a law that was discovered: what it changes, over its covariate, beside what the model without it leaves."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from configs.effects.base import Slot
from diagnosis.discovery.law import DiscoveredLaw
from diagnosis.discovery.place import values_of
from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import Observed
from diagnosis.report.plots.panels import AFTER, MAX_POINTS, MEASURED
from diagnosis.report.report_data import ReportData
from diagnosis.report.sentences.quantities import covariate_axis
from symolo.core.arrays import Array
from symolo.pages.plotting import PALE, finished, png

SIZE_IN = (7.2, 3.6)
BEYOND = 0.08
"""Width that the plot has on each side beyond the data, as a share of their range."""
SHOWN_PERCENT = 98.0
"""Percentage of the rows that determine the height of the plot."""


@dataclass(frozen=True)
class _ShownLaw:
    """The law in the rows of one observed quantity, n rows."""

    observed: Observed
    along: str
    """Name of the covariate along which the law is shown."""
    x: Array
    """(n,), values of the covariate."""
    change: Array
    """(n,), what the law adds to the prediction."""
    left: Array
    """(n,), measured value less the prediction without the law."""
    rows: Mask
    """(n,), rows that are shown."""


def law_plot(data: ReportData, law: DiscoveredLaw) -> bytes:
    """Return the plot as PNG, for the observed quantity in which the law shows most.

    Everything else is as fitted with the law. The grey area is where it was seen.
    """
    shown = _shown(data, law)
    figure = Figure(figsize=SIZE_IN, layout="constrained")
    axes = figure.subplots()
    x, rows = shown.x, shown.rows
    low, high = float(x[rows].min()), float(x[rows].max())
    axes.axvspan(low, high, color=PALE, alpha=0.5, linewidth=0.0, label="seen here")
    _draw_rows(axes, shown)
    order = np.flatnonzero(rows)[np.argsort(x[rows], kind="stable")]
    style = "-" if _is_function(law) else "."
    axes.plot(x[order], shown.change[order], style, color=AFTER, markersize=5, linewidth=1.6, label="the law")
    sizes = np.abs(np.concatenate([shown.left[rows], shown.change[rows]]))
    reach = 1.25 * float(np.percentile(sizes, SHOWN_PERCENT))
    axes.set_ylim(-reach, reach)
    axes.set_xlim(low - BEYOND * (high - low), high + BEYOND * (high - low))
    finished(axes, law.name, covariate_axis(shown.along), f"change of {shown.observed.name} [{shown.observed.unit}]")
    return png(figure)


def _shown(data: ReportData, law: DiscoveredLaw) -> _ShownLaw:
    """Return the law in the observed quantity that it changes most, in standard deviations of the noise."""
    evidence, fit = data.diagnosis.evidence.as_measured(), data.diagnosis.fit
    bare = fit.robot.model_copy(update={"effects": fit.robot.effects.without(law.name)})
    with_law, without = evidence.predicted([fit.robot, bare]).mean + fit.local_change
    usable = evidence.fit | evidence.heldout
    largest = [
        float(np.nanmax(np.where(usable, np.abs(with_law - without) / evidence.sd, 0.0)[place], initial=0.0))
        for place in evidence.places
    ]
    k = int(np.argmax(largest))
    observed, place = evidence.observed[k], evidence.places[k]
    # A law that depends on nothing is shown over the first quantity on which it might.
    along = next(iter(law.form.covariates), observed.covariates[0].name)
    x = values_of(observed)[along]
    change, left = (with_law - without)[place], (evidence.values - without)[place]
    return _ShownLaw(observed, along, x, change, left, usable[place] & np.isfinite(x) & np.isfinite(left))


def _draw_rows(axes: Axes, shown: _ShownLaw) -> None:
    """Draw what the model without the law leaves, in fitted rows as dots and in held-out rows as rings."""
    for some, face, label in (
        (shown.rows & ~shown.observed.holdout, MEASURED, "fitted rows"),
        (shown.rows & shown.observed.holdout, "none", "held-out rows"),
    ):
        at = np.flatnonzero(some)
        at = at[:: max(1, len(at) // MAX_POINTS)]
        axes.plot(
            shown.x[at],
            shown.left[at],
            "o",
            markersize=3.0,
            markerfacecolor=face,
            markeredgecolor=MEASURED,
            markeredgewidth=0.6,
            label=label,
        )


def _is_function(law: DiscoveredLaw) -> bool:
    """Return whether the covariate alone determines the change, so that the law is a curve."""
    form = law.form
    return form.place.slot is Slot.RANGE and len(form.covariates) == 1 and not form.material and not form.place.member

"""Plot of a law that was discovered: what it changes, over its covariate, beside what the model without it leaves."""

import numpy as np
from matplotlib.figure import Figure

from configs.effects.base import Slot
from diagnosis.discovery.law import DiscoveredLaw
from diagnosis.discovery.place import values_of
from diagnosis.report.plots.panels import AFTER, MAX_POINTS, MEASURED
from diagnosis.report.report_data import ReportData
from diagnosis.report.sentences.quantities import covariate_axis
from symolo.pages.plotting import PALE, finished, png

SIZE_IN = (7.2, 3.6)
BEYOND = 0.08
"""Width that the plot has on each side beyond the data, as a share of their range."""
SHOWN_PERCENT = 98.0
"""Percentage of the rows that determine the height of the plot."""


def law_plot(data: ReportData, law: DiscoveredLaw) -> bytes:
    """Return the plot as PNG, for the observed quantity in which the law shows most.

    Everything else is as fitted with the law. The grey area is where it was seen.
    """
    diagnosis = data.diagnosis
    evidence, fit = diagnosis.evidence.as_measured(), diagnosis.fit
    bare = fit.robot.model_copy(update={"effects": fit.robot.effects.without(law.name)})
    with_law, without = evidence.predicted([fit.robot, bare]).mean + fit.local_change
    usable = evidence.fit | evidence.heldout
    shown = [
        float(np.nanmax(np.where(usable, np.abs(with_law - without) / evidence.sd, 0.0)[place], initial=0.0))
        for place in evidence.places
    ]
    k = int(np.argmax(shown))
    observed, place = evidence.observed[k], evidence.places[k]
    # A law that depends on nothing is shown over the first quantity on which it might.
    along = next(iter(law.form.covariates), observed.covariates[0].name)
    x = values_of(observed)[along]
    change, left = (with_law - without)[place], (evidence.values - without)[place]
    rows = usable[place] & np.isfinite(x) & np.isfinite(left)
    figure = Figure(figsize=SIZE_IN, layout="constrained")
    axes = figure.subplots()
    low, high = float(x[rows].min()), float(x[rows].max())
    axes.axvspan(low, high, color=PALE, alpha=0.5, linewidth=0.0, label="seen here")
    for some, face, label in (
        (rows & ~observed.holdout, MEASURED, "fitted rows"),
        (rows & observed.holdout, "none", "held-out rows"),
    ):
        at = np.flatnonzero(some)
        at = at[:: max(1, len(at) // MAX_POINTS)]
        axes.plot(
            x[at],
            left[at],
            "o",
            markersize=3.0,
            markerfacecolor=face,
            markeredgecolor=MEASURED,
            markeredgewidth=0.6,
            label=label,
        )
    order = np.flatnonzero(rows)[np.argsort(x[rows], kind="stable")]
    is_function = (
        law.form.place.slot is Slot.RANGE
        and len(law.form.covariates) == 1
        and not law.form.material
        and not law.form.place.member
    )
    axes.plot(
        x[order], change[order], "-" if is_function else ".", color=AFTER, markersize=5, linewidth=1.6, label="the law"
    )
    reach = 1.25 * float(np.percentile(np.abs(np.concatenate([left[rows], change[rows]])), SHOWN_PERCENT))
    axes.set_ylim(-reach, reach)
    axes.set_xlim(low - BEYOND * (high - low), high + BEYOND * (high - low))
    finished(axes, law.name, covariate_axis(along), f"change of {observed.name} [{observed.unit}]")
    return png(figure)

"""Plot of the errors of each quantity on held-out rows, for the nominal, the fitted and the extended robot."""

from math import sqrt

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from diagnosis.inference.gain import KEPT_SHARE
from diagnosis.measured.noise import mean_of_smallest_squares
from diagnosis.report.plots.panels import AFTER, BEFORE, CALIBRATED
from diagnosis.report.report_data import ReportData
from symolo.pages.plotting import GREY, finished, png, set_margins, width_of_labels_in

MARKER_OFFSET = 0.14
MARKERS = ("x", "s", "o")


def gain_plot(data: ReportData) -> bytes:
    """Return the plot as PNG; there must be held-out rows."""
    by_quantity = data.by_quantity
    places = np.arange(len(by_quantity))
    points = [
        ("nominal", BEFORE, [quantity.extended.before for quantity in by_quantity]),
        ("nominal, fitted", CALIBRATED, [quantity.calibrated.after for quantity in by_quantity]),
    ]
    if data.diagnosis.fitted_effects:
        points.append(("extended", AFTER, [quantity.extended.after for quantity in by_quantity]))
    figure = Figure(figsize=(7.2, 1.3 + 0.42 * len(by_quantity)))
    left_in = width_of_labels_in(quantity.name for quantity in by_quantity)
    set_margins(figure, 1, left_in=left_in, bottom_in=0.5, top_in=0.5)
    axes = figure.subplots()
    for k, (name, colour, errors) in enumerate(points):
        at = places + (k - (len(points) - 1) / 2) * MARKER_OFFSET
        axes.plot(errors, at, MARKERS[k], color=colour, label=name, markersize=7)
    axes.axvline(noise_alone(), color=GREY, linestyle="--", linewidth=1.0, label="noise alone")
    axes.set_xscale("log")
    all_errors = np.concatenate([errors for *_, errors in points])
    axes.set_xlim(0.7 * min(float(all_errors.min()), noise_alone()), 1.4 * max(float(all_errors.max()), 1.0))
    axes.set_xticks(round_ticks(*axes.get_xlim()))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_yticks(places.tolist(), [quantity.name for quantity in by_quantity], fontsize="small")
    axes.set_ylim(len(by_quantity) - 0.5, -0.5)
    finished(axes, "Error on the held-out rows", "error [σ]", "", beside=True)
    return png(figure)


def round_ticks(low: float, high: float) -> list[float]:
    """Return round numbers between two limits: 1, 2 and 5 of each decade, or every tenth where the axis is short."""
    ticks = [tick * 10.0**power for power in range(-3, 6) for tick in (1.0, 2.0, 5.0)]
    inside = [tick for tick in ticks if low <= tick <= high]
    if len(inside) > 1:
        return inside
    return [tick / 10.0 for tick in range(1, 100) if low <= tick / 10.0 <= high]


def noise_alone() -> float:
    """Return the error of a perfect model in sigmas: less than 1, since the largest residuals are left out."""
    return sqrt(mean_of_smallest_squares(KEPT_SHARE))

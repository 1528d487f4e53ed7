"""Error of each quantity on held-out rows, by the nominal robot, the fitted one and the extended one."""

from math import sqrt

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from diagnosis.inference.gain import KEPT
from diagnosis.measured.noise import mean_of_smallest_squares
from diagnosis.report.findings import Findings
from diagnosis.report.plots.panels import AFTER, BEFORE, CALIBRATED
from symolo.pages.plotting import GREY, finished, png

APART = 0.14
MARKERS = ("x", "s", "o")


def gain_picture(found: Findings) -> bytes:
    """As PNG; there must be held-out rows."""
    by_quantity = found.by_quantity
    places = np.arange(len(by_quantity))
    points = [
        ("nominal", BEFORE, [of.extended.before for of in by_quantity]),
        ("nominal, fitted", CALIBRATED, [of.calibrated.after for of in by_quantity]),
    ]
    if found.diagnosis.named:
        points.append(("extended", AFTER, [of.extended.after for of in by_quantity]))
    figure = Figure(figsize=(7.2, 1.3 + 0.42 * len(by_quantity)), layout="constrained")
    axes = figure.subplots()
    for k, (name, colour, errors) in enumerate(points):
        at = places + (k - (len(points) - 1) / 2) * APART
        axes.plot(errors, at, MARKERS[k], color=colour, label=name, markersize=7)
    axes.axvline(noise_alone(), color=GREY, linestyle="--", linewidth=1.0, label="noise alone")
    axes.set_xscale("log")
    least, most = min(min(e) for *_, e in points), max(max(e) for *_, e in points)
    axes.set_xlim(0.7 * min(least, noise_alone()), 1.4 * max(most, 1.0))
    ticks = [tick for power in range(-3, 6) for tick in (10.0**power, 2.0 * 10.0**power, 5.0 * 10.0**power)]
    low, high = axes.get_xlim()
    axes.set_xticks([tick for tick in ticks if low <= tick <= high])
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_yticks(places.tolist(), [of.name for of in by_quantity], fontsize="small")
    axes.set_ylim(len(by_quantity) - 0.5, -0.5)
    finished(axes, "Error on the rows held out", "error [σ]", "", beside=True)
    return png(figure)


def noise_alone() -> float:
    """Error of a perfect model in sigmas: less than 1, since the largest residuals are left out."""
    return sqrt(mean_of_smallest_squares(KEPT))

"""Error of each quantity on held-out rows, by the nominal robot, the fitted one and the extended one."""

import numpy as np
from matplotlib.figure import Figure

from diagnosis.benches.plotting import GREY, finished, png
from diagnosis.report.findings import Findings
from diagnosis.report.panels import AFTER, BEFORE, CALIBRATED

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
    axes.axvline(1.0, color=GREY, linestyle="--", linewidth=1.0, label="noise alone")
    axes.set_xscale("log")
    axes.set_yticks(places.tolist(), [of.name for of in by_quantity], fontsize="small")
    axes.set_ylim(len(by_quantity) - 0.5, -0.5)
    finished(axes, "Error on the rows held out", "error [σ]", "", beside=True)
    return png(figure)

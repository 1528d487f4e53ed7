"""Plot of the predictions for unseen runs, with their 95 % intervals."""

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from diagnosis.prediction_error import SD, UnseenPrediction
from diagnosis.predictors.base import ROW_TIME
from diagnosis.report.plots.panels import AFTER
from diagnosis.report.sentences.quantities import axis
from symolo.core.arrays import Array
from symolo.pages.plotting import finished, png, set_margins

NORMAL_95 = 1.96


def unseen_plot(prediction: UnseenPrediction) -> bytes:
    """Return one panel for each reading as PNG."""
    name, x = prediction.along
    names = prediction.readings
    figure = Figure(figsize=(3.4 * len(names), 3.1))
    set_margins(figure, len(names), left_in=0.92, bottom_in=0.5, top_in=0.3, between_in=0.92)
    for axes, reading in zip(figure.subplots(1, len(names), squeeze=False)[0], names, strict=True):
        mean, half = prediction.columns[reading], NORMAL_95 * prediction.columns[f"{SD}{reading}"]
        for rows in _stretches(x, is_log=name == ROW_TIME):
            axes.fill_between(x[rows], (mean - half)[rows], (mean + half)[rows], color=AFTER, alpha=0.2, linewidth=0)
            axes.plot(x[rows], mean[rows], "-" if name == ROW_TIME else ".", color=AFTER, linewidth=1.0, markersize=4)
        finished(axes, reading, axis(name), axis(reading), legend=False)
    return png(figure)


def _stretches(x: Array, *, is_log: bool) -> list[NDArray[np.intp]]:
    """Return the rows of each trial of a log, or all rows of a bench in the order of what is swept."""
    if not is_log:
        return [np.argsort(x, kind="stable")]
    return np.split(np.arange(len(x)), np.flatnonzero(np.diff(x) < 0.0) + 1)

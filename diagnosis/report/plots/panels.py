"""One panel of residuals along a covariate, and the parts that all plots of the report share."""

from textwrap import fill

import numpy as np
from matplotlib.axes import Axes

from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import Covariate, CovariateShape
from diagnosis.report.sentences.quantities import covariate_axis
from symolo.core.arrays import Array
from symolo.pages.plotting import BLACK, BLUE, GREY, ORANGE, PALE, VERMILION

BEFORE, CALIBRATED, AFTER, MEASURED = VERMILION, ORANGE, BLUE, BLACK
MAX_POINTS = 1000
"""Largest number of points in a panel; if there are more, every nth is drawn."""
BINS = 20
MIN_IN_BIN = 3
MEDIAN_ERROR = 1.2533
"""Standard error of a median relative to that of a mean, for normal noise: the root of pi/2."""
SHOWN_PERCENT = 97.0
"""Percentage of the residuals that determine the height of a panel; those beyond it are triangles at its edge."""
MIN_REACH_SIGMA = 3.5
"""Smallest height of a panel, so that noise looks like noise."""

LABEL_WIDTH = 30
"""Characters in a line of the label below a panel; longer lines would run into those of its neighbours."""


def residual_panel(  # noqa: PLR0917 - an order that reads well: where, what, how
    axes: Axes, covariate: Covariate, z: Array, heldout: Mask, colour: str, reach: float | None = None
) -> None:
    """Draw residuals in sigmas, held-out rows as rings, and their median in bins with two standard errors.

    Args:
        axes: To draw in.
        covariate: (n,) values; if it is a place, the residual is shown as a colour.
        z: (n,), NaN where there is no residual.
        heldout: (n,), which rows are held out.
        colour: Colour of the points.
        reach: Height of the panel in sigmas; determined from `z` if None.
    """
    shown = np.isfinite(z) & np.isfinite(covariate.values)
    if covariate.second is not None:
        _place(axes, covariate, z, shown)
        return
    x = np.mod(covariate.values, 2.0 * np.pi) if covariate.shape is CovariateShape.PERIODIC else covariate.values
    reach = reach_of(z[shown]) if reach is None else reach
    axes.axhspan(-2.0, 2.0, color=PALE, alpha=0.6, linewidth=0.0)
    axes.axhline(0.0, color=GREY, linewidth=0.6)
    beyond = np.abs(z) > reach
    at = x + _jitter(covariate, len(x))
    faint = 0.85 if np.count_nonzero(shown) < 200 else 0.4
    for rows, face in ((shown & ~heldout & ~beyond, colour), (shown & heldout & ~beyond, "none")):
        some = np.flatnonzero(rows)
        some = some[:: max(1, len(some) // MAX_POINTS)]
        dots = {"markersize": 3.3, "markerfacecolor": face, "markeredgecolor": colour, "markeredgewidth": 0.7}
        axes.plot(at[some], z[some], "o", alpha=faint, **dots)
    for rows, marker, edge in ((shown & (z > reach), "^", 0.95), (shown & (z < -reach), "v", -0.95)):
        axes.plot(at[rows], np.full(np.count_nonzero(rows), edge * reach), marker, markersize=4, color=colour)
    middle, median, error = binned(covariate, x[shown], z[shown])
    if len(middle) > 1 and np.count_nonzero(shown) > 2 * BINS:
        axes.errorbar(middle, median, 2.0 * error, color=BLACK, linewidth=1.0, linestyle="none", capsize=2, marker=".")
    axes.set_ylim(-reach, reach)
    axes.set_xlabel(label_below(covariate))
    axes.grid(alpha=0.3)
    _ticks(axes, covariate)


def label_below(covariate: Covariate) -> str:
    """Return the label below a panel, in one or several lines."""
    return fill(covariate_axis(covariate.name), LABEL_WIDTH)


def reach_of(z: Array) -> float:
    """Return the height in sigmas of a panel of residuals."""
    z = z[np.isfinite(z)]
    return max(MIN_REACH_SIGMA, 1.4 * float(np.percentile(np.abs(z), SHOWN_PERCENT))) if len(z) else MIN_REACH_SIGMA


def binned(covariate: Covariate, x: Array, z: Array) -> tuple[Array, Array, Array]:
    """Return middle, median and standard error of the median, (k,) each, of categories or of bins with equal counts."""
    if covariate.shape is CovariateShape.CATEGORY:
        groups = [x == value for value in np.unique(x)]
    else:
        edges = np.unique(np.quantile(x, np.linspace(0.0, 1.0, BINS + 1))) if len(x) else np.zeros(0)
        number = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, max(len(edges) - 2, 0))
        groups = [number == k for k in range(max(len(edges) - 1, 0))]
    groups = [group for group in groups if np.count_nonzero(group) >= MIN_IN_BIN]
    middle = np.array([float(np.mean(x[group])) for group in groups])
    median = np.array([float(np.median(z[group])) for group in groups])
    # The median absolute deviation of normal noise is its standard deviation over 1.4826; outliers hardly change it.
    spread = [1.4826 * float(np.median(np.abs(z[group] - m))) for group, m in zip(groups, median.tolist(), strict=True)]
    error = np.array([MEDIAN_ERROR * s / np.sqrt(np.count_nonzero(g)) for s, g in zip(spread, groups, strict=True)])
    return middle, median, error


def _jitter(covariate: Covariate, rows: int) -> Array:
    """Return offsets from the category, so that points do not hide each other; by row, so that they are not random."""
    if covariate.shape is not CovariateShape.CATEGORY:
        return np.zeros(rows)
    # Multiples of the golden ratio fill an interval evenly, however many there are.
    return 0.5 * (np.mod(np.arange(rows) * 0.618034, 1.0) - 0.5)


def _ticks(axes: Axes, covariate: Covariate) -> None:
    if covariate.shape is not CovariateShape.CATEGORY:
        return
    values = np.unique(covariate.values[np.isfinite(covariate.values)])
    if len(values) > BINS:
        return
    names = [covariate.labels[int(v)] if int(v) < len(covariate.labels) else f"{v:g}" for v in values.tolist()]
    axes.set_xticks(values.tolist(), names, rotation=30 if covariate.labels else 0, fontsize="small")


def _place(axes: Axes, covariate: Covariate, z: Array, shown: Mask) -> None:
    some = np.flatnonzero(shown)
    some = some[:: max(1, len(some) // MAX_POINTS)]
    second = covariate.second if covariate.second is not None else covariate.values
    reach = max(MIN_REACH_SIGMA, float(np.percentile(np.abs(z[some]), 95.0))) if len(some) else MIN_REACH_SIGMA
    points = axes.scatter(
        covariate.values[some], second[some], c=z[some], s=9, cmap="RdBu_r", vmin=-reach, vmax=reach, linewidths=0.0
    )
    axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
    axes.grid(alpha=0.3)
    figure = axes.get_figure()
    if figure is not None:
        figure.colorbar(points, ax=axes, label="residual [σ]")

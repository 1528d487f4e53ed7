"""The likelihood of an offset that switches on and off with a period, beside white noise: a lamp near the target."""

import numpy as np
from numpy.typing import NDArray

from diagnosis.inference.unexplained.drift.periods import squares_of_repeating
from diagnosis.inference.unexplained.drift.range_series import RangeSeries
from symolo.core.arrays import Array

BINS = 32
"""Parts of a period into which the rows are sorted at first."""


def squares_of_switching(series: RangeSeries) -> tuple[float, float]:
    """Return the squares that the best offset leaves which switches on and off, and how many periods it could have.

    The squares are in standard deviations of the rows, about a level of the readings while the offset is off.

    Args:
        series: The residuals in order of time.
    """
    weight = series.sd_m**-2.0

    def explained(phase: Array) -> float:
        order = np.argsort(phase, kind="stable")
        return _explained(weight[order], (weight * series.residual_m)[order])

    def in_bins(phase: Array) -> float:
        return _explained(*_in_bins(phase, weight, series.residual_m))

    return squares_of_repeating(series, explained, coarsely=in_bins)


def _in_bins(phase: Array, weight: Array, residual_m: Array) -> tuple[Array, Array]:
    """Return the sums of weights and of weighted residuals in each part of a period."""
    part: NDArray[np.int64] = (BINS * phase).astype(np.int64)
    inside, total = (np.bincount(part, values, BINS).astype(np.float64) for values in (weight, weight * residual_m))
    return inside, total


def _explained(weights: Array, sums: Array) -> float:
    """Return the squares that two levels explain, one in a window of the phase and one outside it, at the best window.

    Args:
        weights: (n,), weights in order of the phase.
        sums: (n,), weighted residuals.
    """
    upto = np.append(0.0, np.cumsum(weights)), np.append(0.0, np.cumsum(sums))
    inside, inner = (np.subtract.outer(values, values) for values in upto)
    outside, outer = upto[0][-1] - inside, upto[1][-1] - inner
    # What is inside a window may as well be on as off, so that windows across the end of a period are complements.
    is_window = (inside > 0.0) & (outside > 0.0)
    both = np.divide(inner**2, inside, out=np.zeros_like(inner), where=is_window)
    both += np.divide(outer**2, outside, out=np.zeros_like(inner), where=is_window)
    return float(both.max())

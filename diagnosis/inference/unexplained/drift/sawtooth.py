"""The likelihood of an offset that grows and is reset with a period, beside white noise.

A sensor that is calibrated from time to time has such an offset.
"""

import numpy as np

from diagnosis.inference.unexplained.drift.periods import squares_of_repeating
from diagnosis.inference.unexplained.drift.range_series import RangeSeries
from symolo.core.arrays import Array

MIN_SHARE = 1e-9
"""Share of a sawtooth that is no constant, below which it is only rounding error."""


def squares_of_sawtooth(series: RangeSeries) -> tuple[float, float]:
    """Return the squares that the best sawtooth leaves, and how many periods it could have.

    The squares are in standard deviations of the rows. The sawtooth grows or falls in proportion to the time since the
    last reset, about a level of the readings.

    Args:
        series: The residuals in order of time.
    """
    weight = series.sd_m**-2.0

    def explained(phase: Array) -> float:
        return _explained(phase, weight, series.residual_m)

    return squares_of_repeating(series, explained, coarsely=explained)


def _explained(phase: Array, weight: Array, residual_m: Array) -> float:
    """Return the squares that a level and the time since the best moment of a period explain.

    Args:
        phase: (n,), share of the period that has passed.
        weight: (n,), inverse variances.
        residual_m: (n,), the residuals.
    """
    order = np.argsort(phase, kind="stable")
    phase, weight, weighted = phase[order], weight[order], (weight * residual_m)[order]
    # A reset at the phase of a row leaves phase + 1 before it, up to a constant, and phase from it on.
    before, before_phase, before_sum = (
        np.append(0.0, np.cumsum(values)[:-1]) for values in (weight, weight * phase, weighted)
    )
    whole, total = float(weight.sum()), float(weighted.sum())
    mean = (float(weight @ phase) + before) / whole
    spread = float(weight @ phase**2) + 2.0 * before_phase + before - whole * mean**2
    along = float(weighted @ phase) + before_sum - mean * total
    slopes = np.divide(along**2, spread, out=np.zeros_like(along), where=spread > MIN_SHARE * whole)
    return total**2 / whole + float(slopes.max())

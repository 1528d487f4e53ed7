"""Figures by which curves and readings are measured."""

import numpy as np

from symolo.core.arrays import Array


def first_reached(x: Array, y: Array, level: float) -> float:
    """Return where y (N,) first reaches a level, by linear interpolation; NaN if it never does, or begins there."""
    reached = y >= level
    if reached[0] or not reached.any():
        return np.nan
    after = int(np.argmax(reached))
    share = (level - y[after - 1]) / (y[after] - y[after - 1])
    return float(x[after - 1] + share * (x[after] - x[after - 1]))


def rms(residuals: Array) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(residuals**2)))


def mean_and_sd(values: Array) -> tuple[float, float]:
    """Return mean and standard deviation of a sample (N,)."""
    return float(values.mean()), float(values.std(ddof=1))

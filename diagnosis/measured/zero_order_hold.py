"""Inputs that change between the rows of a log: each value is held until the next one."""

import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array


def held_means(begins_s: Array, values: Array | NDArray[np.int64], from_s: Array, duration_s: float | Array) -> Array:
    """Return the means (n,) of a held value over periods.

    Args:
        begins_s: (N,), times from which the values are held; the first one is held before its time, too.
        values: (N,), NaN where a value is missing, so that the one before is held.
        from_s: (n,), beginnings of the periods.
        duration_s: Duration of the periods, one or (n,).
    """
    values = np.asarray(values, dtype=np.float64)
    known = np.isfinite(values)
    if not known.any():
        return np.full(len(from_s), np.nan)
    held, begins = values[known], begins_s[known]
    integral = np.concatenate([[0.0], np.cumsum(held[:-1] * np.diff(begins))])

    def until(t: Array) -> Array:
        last = np.clip(np.searchsorted(begins, t, side="right") - 1, 0, len(begins) - 1)
        return integral[last] + held[last] * (t - begins[last])

    return (until(from_s + duration_s) - until(from_s)) / duration_s

"""Linear regression of a reading on voltages and earlier readings, without its outliers."""

import numpy as np

from symolo.core.arrays import Array

OUTLIERS = 9.0
"""Multiple of the median size of the residuals beyond which a row is left out."""


def columns_of(rows: Array) -> Array:
    """Return the columns (n, k + 1) of a regression with a constant, from rows (n, k + 1) that end with the reading."""
    return np.hstack([rows[:, :-1], np.ones((len(rows), 1))])


def regression(rows: Array) -> tuple[Array, Array]:
    """Return the weights (k + 1,) of the columns and the residuals (n,)."""
    columns = columns_of(rows)
    weights: Array = np.linalg.lstsq(columns, rows[:, -1], rcond=None)[0]
    return weights, rows[:, -1] - columns @ weights


def without_outliers(rows: Array) -> Array:
    """Return the rows whose residuals are not far larger than usual."""
    rest = np.abs(regression(rows)[1])
    return rows[rest <= OUTLIERS * np.median(rest)]

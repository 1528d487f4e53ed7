"""The part of a quantity of a drive that follows from the commanded motion.

A controller raises the voltage of a wheel that is slowed down by a bump. So voltage and predicted speed depend on the
disturbances of the measured speed, and a residual would seem to depend on them. The commanded motion does not know of
disturbances: it is an instrument, and what it predicts of the voltage, from its last rows, has no part of them (two-
stage least squares: Theil 1953; Wooldridge, Econometric Analysis of Cross Section and Panel Data, 2nd ed., chapter 5).
"""

import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array

LAGS, SIGN_LAGS = 12, 4
"""Rows before, by which the commands and their signs act: 0.6 s of a drive is several time constants of a motor."""
MIN_SHARE = 0.5
"""Share of the variance of a quantity that the commands must explain. Otherwise it was not controlled by them."""
MIN_ROWS = 60


def as_commanded(values: Array, set_speed: Array, trial: NDArray[np.int64]) -> Array:
    """Return the part of values (n,) that follows from a set speed (n,); the values themselves where it does not.

    Args:
        values: Quantity of each row.
        set_speed: Commanded speed, NaN where it was not logged.
        trial: Trial of each row; before its first row, the set speed is 0.
    """
    if len(values) < MIN_ROWS:
        return values
    columns = np.stack([*_lagged(set_speed, trial, LAGS), *_lagged(np.sign(set_speed), trial, SIGN_LAGS)], axis=1)
    columns = np.concatenate([columns, np.ones((len(values), 1))], axis=1)
    rows = np.isfinite(values) & np.isfinite(columns).all(axis=1)
    if np.count_nonzero(rows) < MIN_ROWS:
        return values
    fitted = columns @ np.linalg.lstsq(columns[rows], values[rows], rcond=1e-8)[0]
    if np.var(values[rows] - fitted[rows]) > (1.0 - MIN_SHARE) * np.var(values[rows]):
        return values
    return np.where(np.isfinite(values), fitted, np.nan)


def _lagged(values: Array, trial: NDArray[np.int64], lags: int) -> list[Array]:
    """Return values (n,) of the row itself and of each of the rows before, 0 before the first row of a trial."""
    columns = [values]
    for lag in range(1, lags + 1):
        before = np.concatenate([np.zeros(lag), values[:-lag]])
        same = np.concatenate([np.zeros(lag, dtype=bool), trial[lag:] == trial[:-lag]])
        columns.append(np.where(same, before, 0.0))
    return columns

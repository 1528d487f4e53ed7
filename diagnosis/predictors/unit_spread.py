"""Readings without what differs from unit to unit in gain and offset, as white noise.

A sensor whose gain and offset have tolerances reads, beside its noise, an error that is correlated over all rows. Two
fitted numbers for each channel and run would be many; here the same follows without a fit. If the errors of the n rows
in sigmas of the noise have the covariance I + A A', with a column of A for each gain and offset, a rotation turns the
columns of A into orthogonal ones, and a shrinkage along these makes the covariance I: the likelihood is that of fits
with all tolerances as priors (Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, eq. 2.38
and 2.40 with a linear kernel).
"""

from dataclasses import dataclass

import numpy as np

from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array

ROUNDS = 20
CORNER = 1.5
"""Residual in sigmas from which a reading has less weight."""
OUTLIER = 4.0
"""Residual in sigmas from which a reading does not count for gain and offset."""


@dataclass(frozen=True)
class UnitSpread:
    """Numbers with tolerances, K of them, on which n readings depend."""

    spread: Array
    """(n, K), change of the readings by one tolerance of each number, in sigmas of the noise."""
    rows: Mask
    """(n,), readings that determine the numbers."""
    _left: Array
    """(rows, K), orthogonal directions of these readings."""
    _to_parameters: Array
    """(K, K), numbers in tolerances by the projections on these directions."""
    _shrinkage: Array
    """(K,), share of the projections that is removed."""

    @classmethod
    def of(cls, spread: Array, residuals: Array, rows: Mask) -> "UnitSpread":
        """Return the spread of readings; those with wild residuals (n,) [sigmas] determine nothing."""
        counted = rows & np.isfinite(residuals)
        chosen, off = spread[counted], residuals[counted]
        for _ in range(ROUNDS):
            # Huber's weights: a wild row pulls no more than one at the corner.
            weighted = chosen / np.maximum(np.abs(off) / CORNER, 1.0)[:, None]
            off = residuals[counted] - chosen @ np.linalg.solve(
                np.eye(spread.shape[1]) + weighted.T @ chosen, weighted.T @ residuals[counted]
            )
        inside = np.zeros_like(counted)
        inside[np.flatnonzero(counted)[np.abs(off) <= OUTLIER]] = True
        left, singular, right = np.linalg.svd(spread[inside], full_matrices=False)
        to_parameters = (right.T * singular) / (1.0 + singular**2)
        return cls(spread, inside, left, to_parameters, 1.0 - 1.0 / np.sqrt(1.0 + singular**2))

    def without(self, residuals: Array) -> Array:
        """Return residuals (..., n) in sigmas without this spread; NaN only where they are NaN."""
        along = residuals[..., self.rows] @ self._left
        cleaned = residuals - (along @ self._to_parameters.T) @ self.spread.T
        cleaned[..., self.rows] = residuals[..., self.rows] - (along * self._shrinkage) @ self._left.T
        return cleaned

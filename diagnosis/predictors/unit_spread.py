"""Readings without the errors of gains and offsets that differ from unit to unit.

The gain and the offset of a channel have tolerances. Beside its noise, the channel therefore has an error that is the
same, or in proportion to the reading, in all rows of a run. To fit two more numbers for each channel and run would take
long. Instead, the readings are transformed, so that the errors of all rows become independent of each other.

Let r be the errors of n rows in sigmas of the noise, and column k of A their change by one tolerance of number k. Then
the covariance of r is I + A A'. With the singular value decomposition A = U S V', the symmetric matrix
W = I - U (I - (I + S^2)^-1/2) U' makes W r white noise, and the sum of its squares is that of a fit with all tolerances
as priors (Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, eq. 2.38 and 2.40 with a linear
kernel).

Held-out rows are judged given the fitted ones. From these, the numbers have the mean V S (I + S^2)^-1 U' r and the
covariance P = I - V S^2 (I + S^2)^-1 V'. The errors of the held-out rows then have the mean A m and the covariance
I + A P A', and are transformed in the same way with A L instead of A, where L L' = P. Without fitted rows, m is 0 and P
is I.
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
class _Whitening:
    """Rows whose errors have the covariance I + A A', and the numbers in tolerances that follow from them."""

    rows: Mask
    """(n,), the m rows."""
    left: Array
    """(m, k), columns of U."""
    shrinkage: Array
    """(k,), share of the projection on each column that is removed."""
    to_numbers: Array
    """(K, k), mean of the numbers by these projections."""
    root: Array
    """(K, K), L of the covariance L L' of the numbers, given these rows."""

    @classmethod
    def of(cls, spread: Array, residuals: Array, rows: Mask) -> "_Whitening":
        """Return the whitening of those of some rows (n,) that are not wild, by spread (n, K) and residuals (n,)."""
        inside = _without_wild(spread, residuals, rows)
        left, singular, right = np.linalg.svd(spread[inside], full_matrices=False)
        shrinkage = 1.0 - 1.0 / np.sqrt(1.0 + singular**2)
        # The root of a symmetric matrix has the roots of its eigenvalues.
        root = np.eye(spread.shape[1]) - (right.T * shrinkage) @ right
        return cls(inside, left, shrinkage, (right.T * singular) / (1.0 + singular**2), root)

    def along(self, residuals: Array) -> Array:
        return residuals[..., self.rows] @ self.left

    def whitened(self, residuals: Array) -> Array:
        """Return residuals (..., m) of the rows, from those of all rows (..., n)."""
        return residuals[..., self.rows] - (self.along(residuals) * self.shrinkage) @ self.left.T


@dataclass(frozen=True)
class UnitSpread:
    """Numbers with tolerances, K of them, on which n readings depend."""

    spread: Array
    """(n, K), change of the readings by one tolerance of each number, in sigmas of the noise."""
    _fitted: _Whitening
    _heldout: _Whitening
    """Whitening of the held-out rows without what the fitted rows predict of them."""
    _left: Array
    """(n, K), change of the readings by what the fitted rows leave of the tolerances."""
    _later: Mask
    """(n,), held-out rows."""
    _sd: Array
    """(n,), standard deviation of a reading, given the fitted rows, and a held-out one given the held-out rows too."""

    @classmethod
    def of(cls, spread: Array, residuals: Array, fitted: Mask, heldout: Mask) -> "UnitSpread":
        """Return the spread of readings.

        Args:
            spread: (n, K), change of the readings by one tolerance of each number, in sigmas of the noise.
            residuals: (n,), measured minus predicted readings in these sigmas. Rows with wild ones determine nothing.
            fitted: (n,), rows from which the numbers are known.
            heldout: (n,), other rows with readings.
        """
        by_fitted = _Whitening.of(spread, residuals, fitted)
        left = spread @ by_fitted.root
        predicted = by_fitted.along(np.nan_to_num(residuals)) @ by_fitted.to_numbers.T @ spread.T
        by_heldout = _Whitening.of(left, residuals - predicted, heldout)
        root = np.where(heldout[:, None], left @ by_heldout.root, left)
        return cls(spread, by_fitted, by_heldout, left, heldout, np.sqrt(1.0 + (root**2).sum(axis=1)))

    def without(self, residuals: Array) -> Array:
        """Return residuals (..., n) in sigmas without this spread; NaN only where they are NaN."""
        off = residuals - self._fitted.along(residuals) @ self._fitted.to_numbers.T @ self.spread.T
        by_heldout = self._heldout.along(off) @ self._heldout.to_numbers.T @ self._left.T
        # Of the rows that determine nothing, each is judged by itself.
        cleaned = np.where(self._later, off - by_heldout, off) / self._sd
        cleaned[..., self._fitted.rows] = self._fitted.whitened(residuals)
        cleaned[..., self._heldout.rows] = self._heldout.whitened(off)
        return cleaned


def _without_wild(spread: Array, residuals: Array, rows: Mask) -> Mask:
    """Return those of some rows (n,) whose residuals are not wild beside the best numbers."""
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
    return inside

"""Readings without the errors of gains and offsets that differ from unit to unit.

The gain and the offset of a channel have tolerances. Beside its noise, the channel therefore has an error that is the
same, or in proportion to the reading, in all rows of a run. To fit two more numbers for each channel and run would take
long. Instead, the residuals are transformed, so that the errors of all rows become independent of each other.

Let r be the errors of n rows in sigmas of the noise, and column k of A their change by one tolerance of number k. Then
the covariance of r is I + A A'. With the eigenvectors A'A = V L V' and Q = (I + L)^1/2, the symmetric matrix
W = I - A V (Q (Q + I))^-1 V' A' makes W r white noise. The sum of its squares is that of a fit with all tolerances as
priors (Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, eq. 2.38 and 2.40 with a linear kernel).
This is the profile of the likelihood, at the most probable numbers. The marginal likelihood would add log|I + A A'| to
the cost. This term is left out, although A, and with it the term, may change a little between robots.

Held-out rows are judged given the fitted ones. From these, the numbers have the mean m = P A' r and the covariance
P = (I + A'A)^-1. The errors of the held-out rows then have the mean A m and the covariance I + A P A', and are
transformed in the same way with A P^1/2 instead of A. Without fitted rows, m is 0 and P is I.
"""

from dataclasses import dataclass

import numpy as np

from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array

ROUNDS = 6
CORNER = 1.5
"""Residual in sigmas from which a reading has less weight in the search for wild readings."""
OUTLIER = 4.0
"""Residual in sigmas from which a reading is wild and hardly counts for gain and offset."""


@dataclass(frozen=True)
class Cleaned:
    """Residuals without the errors of K numbers with tolerances."""

    z: Array
    """(n,), residuals in sigmas, which are white noise; 0 in rows without a reading."""
    numbers: Array
    """(K,), most probable numbers in tolerances, by the fitted rows. Their squares are a part of the sum of those of
    `z`."""


def cleaned(spread: Array, residuals: Array, fitted: Mask, heldout: Mask) -> Cleaned:
    """Return residuals without the errors of numbers that differ from unit to unit.

    Args:
        spread: (n, K), change of the readings by one tolerance of each number, in sigmas of the noise.
        residuals: (n,), measured minus predicted readings in these sigmas.
        fitted: (n,), rows from which the numbers are known.
        heldout: (n,), other rows with readings.
    """
    z = np.zeros(len(residuals))
    z[fitted], mean, root = _whitened(spread[fitted], residuals[fitted])
    left = spread[heldout]
    z[heldout], _, _ = _whitened(left @ root, residuals[heldout] - left @ mean)
    return Cleaned(z, mean)


def _whitened(spread: Array, residuals: Array) -> tuple[Array, Array, Array]:
    """Return white residuals (m,), and mean (K,) and root (K, K) of the covariance of the numbers given these rows."""
    weight = _weights(spread, residuals)
    # A row with less weight is one with more noise.
    scaled = spread * weight[:, None]
    values, vectors = np.linalg.eigh(scaled.T @ scaled)
    q = np.sqrt(1.0 + np.maximum(values, 0.0))
    along = vectors.T @ (scaled.T @ (weight * residuals))
    # The weights are taken back, so that a wild reading stays wild.
    white = residuals - spread @ (vectors @ (along / (q * (q + 1.0))))
    return white, vectors @ (along / q**2), (vectors / q) @ vectors.T


def _weights(spread: Array, residuals: Array) -> Array:
    """Return the roots of the weights (m,) of rows: 1, and less for residuals that are wild beside the best numbers."""
    off = residuals
    for _ in range(ROUNDS):
        # Huber's weights: a wild row pulls no more than one at the corner.
        weighted = spread / np.maximum(np.abs(off) / CORNER, 1.0)[:, None]
        mean = np.linalg.solve(np.eye(spread.shape[1]) + weighted.T @ spread, weighted.T @ residuals)
        off = residuals - spread @ mean
    # Unlike a limit, these weights change smoothly, so that the cost of a fit has slopes.
    return OUTLIER / np.maximum(np.abs(off), OUTLIER)

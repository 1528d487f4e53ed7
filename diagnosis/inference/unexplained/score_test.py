"""A score test of functions against the residuals of a fit (Godfrey, Misspecification Tests in Econometrics, 1988)."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import fdtrc

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.projection import beyond, orthonormal
from diagnosis.inference.unexplained.bases import RUNS_OF_OUTLIERS, Basis
from symolo.core.arrays import Array

REWEIGHTINGS = 6
"""Iterations of the weights for outliers."""
CLIP = 3.0
"""Residual in sigmas at which it is clipped."""


class ScoreTest:
    """A test of functions beside a fit, with the directions of all its parameters and rows for their priors."""

    def __init__(self, evidence: Evidence, fit: HypothesisFit, beside: Array) -> None:
        self._evidence = evidence
        self._root = np.where(evidence.fit, np.sqrt(evidence.weight), 0.0)
        z, x = _moved_beside(fit, beside)
        self.z = z
        """(N,), residuals in sigmas, which are not clipped."""
        padded = np.concatenate([beside * self._root[:, None], np.zeros((len(fit.x), beside.shape[1]))])
        self._basis = orthonormal(np.concatenate([fit.tangents(self._root), padded], axis=1))
        self._rows: dict[int, tuple[NDArray[np.intp], Array]] = {}
        """Samples of a quantity that were tested last, and the rows of `_basis` at them, by number of the quantity."""
        residuals = replace(fit, x=x).weighted_residuals(np.clip(z, -CLIP, CLIP), self._root)
        self.residuals = residuals - self._basis @ (self._basis.T @ residuals)
        """(N + P,), weighted clipped residuals in sigmas without all that the parameters could still explain."""

    def test(self, number: int, inside: NDArray[np.intp], basis: Basis, runs: NDArray[np.intp]) -> tuple[float, float]:
        """Return the p-value of a basis over samples `inside`, and the fall of the cost beyond chance.

        They are samples of the quantity `number`, and of others of its stage if it shares no reading. `runs` are the
        places among them at which a row begins, or a run of outliers that are one mistake of the logger.
        """
        columns, tangents = basis.columns * self._root[inside, None], self._tangents_at(number, inside)
        taken = tangents.T @ columns
        combined = beyond(columns, taken)
        k = combined.shape[1]
        if k == 0:
            return 1.0, 0.0
        residuals = self.residuals[inside]
        along = combined.T @ (columns.T @ residuals)
        free = columns @ combined - tangents @ (taken @ combined)
        outside = residuals - free @ along
        explained = float(along @ along) / self._more_noise(number, inside, free)
        # Inside the span of a smooth function, correlated noise has (1 + p)/(1 - p) times the squares of independent
        # noise. The weight in `explained` corrects that. The level is that of single rows, without the weight.
        degrees = max(1, len(inside) - k - 1)
        level = float((outside**2 / self._evidence.weight[inside]).sum()) / degrees
        gain = max(0.0, explained - k * level)
        if basis.what != RUNS_OF_OUTLIERS:
            explained /= _more_squares(free * outside[:, None], runs)
        return f_test(explained, level, k, degrees), gain

    def _tangents_at(self, number: int, inside: NDArray[np.intp]) -> Array:
        """Return the rows of the basis of all parameters at samples of a quantity, of which thousands are tested."""
        if self._rows.get(number, (None,))[0] is not inside:
            self._rows[number] = inside, self._basis[inside]
        return self._rows[number][1]

    def _more_noise(self, number: int, inside: NDArray[np.intp], functions: Array) -> float:
        """Return the squares of the noise inside the span of functions, relative to independent noise; at least 1.

        Two samples with a reading of opposite signs add up along a wave of which they are half a cycle apart.

        Args:
            number: Number of the quantity.
            inside: Its samples in the fit.
            functions: (n, k), orthonormal functions over these samples.
        """
        quantity, first = self._evidence.observed[number], self._evidence.places[number].start
        if quantity.shared is None:
            return 1.0
        whole = np.zeros((len(quantity.values), functions.shape[1]))
        whole[inside - first] = functions
        later = quantity.shared.later
        together = quantity.trial[later:] == quantity.trial[:-later]
        products = (whole[:-later] * whole[later:]).sum(axis=1) * together
        shared = float(products @ quantity.shared.correlation[:-later])
        return max(1.0, 1.0 + 2.0 * shared / functions.shape[1])


def _more_squares(products: Array, runs: NDArray[np.intp]) -> float:
    """Return by which factor runs of outliers scatter more along functions than independent rows; at least 1.

    The errors within a run add up, and runs are independent (Liang and Zeger, Biometrika 73 (1986) 13-22).

    Args:
        products: (n, k), functions times residuals.
        runs: Places at which a row or a run begins.
    """
    return max(1.0, float((np.add.reduceat(products, runs) ** 2).sum()) / max(float((products**2).sum()), 1e-300))


def f_test(explained: float, level: float, functions: int, degrees: float) -> float:
    """Return the probability that chance explains as much as some functions do, by the F distribution.

    Args:
        explained: Squares inside the span of the functions, each weighted by the independent samples it is worth.
        level: Mean square outside the span, which estimates the variance of the noise, whatever it is.
        functions: Number of independent functions.
        degrees: Degrees of freedom of `level`.
    """
    return float(fdtrc(functions, degrees, explained / functions / max(level, 1e-12)))


def _moved_beside(fit: HypothesisFit, columns: Array) -> tuple[Array, Array]:
    """Return residuals (N,) and coordinates (P,) of a fit after a joint linear fit of columns (N, k) and coordinates.

    Outliers are reweighted.
    """
    z, x = fit.z, fit.x
    # With the columns, samples that were outliers may fit, and others may become outliers.
    for _ in range(REWEIGHTINGS if columns.shape[1] else 0):
        root = fit.root_weights(z)
        padded = np.concatenate([columns * root[:, None], np.zeros((len(fit.x), columns.shape[1]))])
        both = np.concatenate([padded, fit.tangents(root)], axis=1)
        solved = np.linalg.lstsq(both, fit.weighted_residuals(fit.z, root), rcond=1e-10)[0]
        z = fit.z - np.concatenate([columns, fit.slopes.T], axis=1) @ solved
        x = fit.x + solved[columns.shape[1] :]
    return z, x

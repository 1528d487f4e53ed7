"""The likelihood of a first-order Gauss-Markov error beside white noise, with the error itself integrated out.

A Kalman filter gives it in a time proportional to the number of rows, for many sizes and time constants of the error
side by side (Saerkkae and Solin, Applied Stochastic Differential Equations, 2019, sections 6.2 and 10.4).
"""

from dataclasses import dataclass

import numpy as np

from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array


@dataclass(frozen=True)
class Likelihoods:
    """Results for T time constants and R ratios."""

    costs: Array
    """(T, R), -2 log-likelihood up to a constant that depends on the number of rows only."""
    levels: Array
    """(T, R), most probable variance of the white noise, relative to that of the rows."""


def likelihoods(
    t_s: Array,
    residual_m: Array,
    sd_m: Array,
    times_s: Array,
    ratios: Array,
    *,
    min_level: float = float(np.finfo(np.float64).tiny),
    max_level: float = np.inf,
) -> Likelihoods:
    """Return the likelihoods of residuals.

    Args:
        t_s: (n,), rising times.
        residual_m: (n,), residuals.
        sd_m: (n,), standard deviations of the white noise, up to a common factor.
        times_s: (T,), time constants.
        ratios: (R,), variances of the error, relative to that of the white noise at the median of `sd_m`.
        min_level: Lower limit for the variance of the white noise, relative to that of the rows.
        max_level: Upper limit for the variance of the white noise, relative to that of the rows.
    """
    unit_m = float(np.median(sd_m))
    noise = (sd_m / unit_m) ** 2
    # Means of equal times may differ in their last digits.
    remaining = np.exp(-np.maximum(np.diff(t_s, prepend=t_s[0]), 0.0)[:, None] / times_s)
    mean = np.zeros((len(times_s), len(ratios)))
    variance = np.broadcast_to(ratios, mean.shape).copy()
    squares, logarithms = np.zeros_like(mean), np.zeros_like(mean)
    for value, white, share in zip((residual_m / unit_m).tolist(), noise.tolist(), remaining, strict=True):
        mean = share[:, None] * mean
        variance = share[:, None] ** 2 * (variance - ratios) + ratios
        total = variance + white
        surprise = value - mean
        squares += surprise**2 / total
        logarithms += np.log(total)
        gain = variance / total
        mean = mean + gain * surprise
        variance = white * gain
    levels = np.clip(squares / len(t_s), min_level, max_level)
    # At the most probable level, the last two terms are equal.
    normal = len(t_s) * (np.log(levels) + 2.0 * np.log(unit_m)) + logarithms
    return Likelihoods(normal + squares / levels - len(t_s), levels)


@dataclass(frozen=True)
class ErrorModel:
    """A Gauss-Markov error beside white noise of known sizes."""

    tau_s: float
    error_m: float
    """Standard deviation of the error."""
    level: float
    """Variance of the white noise, relative to that of the rows."""

    def covariance(self, t_s: Array, sd_m: Array) -> Array:
        """Return the covariance (n, n) of rows at times (n,) with standard deviations (n,) of their white noise."""
        return self.between(t_s, t_s) + np.diag(self.level * sd_m**2)

    def between(self, t_s: Array, other_s: Array) -> Array:
        """Return the covariance (m, n) of the error at times (m,) with that at other times (n,)."""
        return self.error_m**2 * np.exp(-np.abs(t_s[:, None] - other_s) / self.tau_s)


def predictable(t_s: Array, residual_m: Array, sd_m: Array, error: ErrorModel, limit: float) -> Mask:
    """Return which of some residuals are no further from what those before say than a number of standard deviations.

    One that is further away says nothing about the error.

    Args:
        t_s: (n,), rising times.
        residual_m: (n,), residuals.
        sd_m: (n,), standard deviations of the white noise.
        error: The error; its level is not used.
        limit: The number of standard deviations.
    """
    variance = whole = error.error_m**2
    remaining = np.exp(-np.diff(t_s, prepend=t_s[0]) / error.tau_s).tolist()
    mean, near = 0.0, np.zeros(len(t_s), dtype=bool)
    for row, (value, white, share) in enumerate(zip(residual_m.tolist(), (sd_m**2).tolist(), remaining, strict=True)):
        mean, variance = share * mean, share**2 * (variance - whole) + whole
        surprise, total = value - mean, variance + white
        near[row] = abs(surprise) <= limit * total**0.5
        if near[row]:
            mean, variance = mean + variance / total * surprise, white * variance / total
    return near


@dataclass(frozen=True)
class LinearEstimate:
    """Generalised least squares."""

    change: Array
    """(P,), most probable change of the coordinates."""
    covariance: Array
    """(P, P), of the coordinates."""
    squares: float
    """Generalised sum of squares of the residuals after the change."""


def estimate(residual_m: Array, slopes_m: Array, covariance: Array, information: Array, pull: Array) -> LinearEstimate:
    """Return the most probable change of coordinates where errors of different rows are not independent.

    Args:
        residual_m: (n,), residuals.
        slopes_m: (P, n), derivatives of the predictions by the coordinates.
        covariance: (n, n), of the errors.
        information: (P, P), inverse covariance of the change by what is known beside these rows.
        pull: (P,), product of that information with the change that it makes most probable.
    """
    whitened = np.linalg.solve(covariance, np.concatenate([residual_m[None], slopes_m]).T)
    inverse = np.linalg.pinv(slopes_m @ whitened[:, 1:] + information, rcond=1e-10, hermitian=True)
    change = inverse @ (slopes_m @ whitened[:, 0] + pull)
    squares = (residual_m - change @ slopes_m) @ (whitened[:, 0] - whitened[:, 1:] @ change)
    return LinearEstimate(change, inverse, float(squares))

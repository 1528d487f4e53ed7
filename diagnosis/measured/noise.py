"""Estimates of the noise of a channel: standard deviation, and correlation of a sample with the next.

There are two estimators, for two kinds of data. Both use a trimmed variance, so that a few outliers count little: the
mean of the smallest 80 % of the squares, over its expectation for a normal deviate. An outlier affects three second
differences. One outlier in twenty samples makes the standard deviation from differences about 30 % too large.

*Differences*, for a smooth signal sampled often. With noise of variance s^2 whose correlation over k rows is p^k
(AR(1)), the second difference over k rows, x[i-k] - 2 x[i] + x[i+k], has the variance s^2 (6 - 8 p^k + 2 p^2k), to
which a straight line contributes nothing. The ratio of the variances at k = 2 and k = 1 is (1 + p)(3 - p^2)/(3 - p). It
rises with p from 0 to 2 and gives p; then s follows. The curvature of the signal within two rows counts as noise, which
usually makes both too large; they are estimates and not bounds. p near 1 cannot be distinguished from a slow signal. If
a reading has steps that are coarse compared with its noise, most differences are 0, and so is the estimate:
`screening.noise_of` keeps it above the noise of rounding.

*Repeats*, for rows under the same conditions: the pure error (Draper and Smith, Applied Regression Analysis, 3rd ed.,
section 2.1). A group of n rows gives n - 1 independent deviates by Helmert's contrasts.
"""

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import sqrt
from statistics import NormalDist

import numpy as np

from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array

TRIMMED_SHARE = 0.8
"""Share of the squares that a trimmed variance uses."""
BLOCKS = 8
"""Number of blocks that the jackknife leaves out in turn."""
MIN_BLOCK_ROWS = 40
"""Smallest number of rows in a block for which the jackknife gives a useful error."""
MIN_ROWS = 8
"""Smallest number of squares for an estimate."""
MAX_CORRELATION = 0.98
SLOW = 0.9
"""Correlation from which noise cannot be distinguished from a slow signal."""


@dataclass(frozen=True)
class Noise:
    """Estimated noise of a channel."""

    sd: float
    correlation: float
    """Correlation of a sample with the next; 0 for an estimate without it."""
    rows: int
    """Number of squares in the estimate."""
    sd_error: float | None = None
    """Standard error by the jackknife, with each eighth of the rows left out in turn; None with too few rows."""
    correlation_error: float | None = None
    is_resolved: bool = True
    """Whether the steps of the readings are fine enough; if not, `sd` is that of rounding, step / sqrt(12)."""

    @property
    def is_separable(self) -> bool:
        """Return whether the noise can be distinguished from a slow signal.

        If the correlation is nearly 1 within two standard errors, it is more likely the curvature of the signal.
        """
        return self.correlation + 2.0 * (self.correlation_error or 0.0) < SLOW


def trimmed_variance(deviations: Array) -> float:
    """Return the variance about zero of normal deviates with a few outliers among them; NaN are left out."""
    squares = np.sort(deviations[np.isfinite(deviations)] ** 2)
    if not len(squares):
        return float("nan")
    count = max(1, round(TRIMMED_SHARE * len(squares)))
    return float(np.mean(squares[:count])) / mean_of_smallest_squares(count / len(squares))


def mean_of_smallest_squares(share: float) -> float:
    """Return the mean of the smallest squares of a standard normal deviate.

    It is 1 - 2 c pdf(c) / share, where 2 cdf(c) - 1 = share.
    """
    if share >= 1.0:
        return 1.0
    normal = NormalDist()
    bound = normal.inv_cdf(0.5 + 0.5 * share)
    return 1.0 - 2.0 * bound * normal.pdf(bound) / share


def noise_of_differences(values: Array, joined: Mask | None = None) -> Noise | None:
    """Return the noise of a smooth channel; None with fewer than 8 second differences over two rows.

    Args:
        values: (N,), NaN where no sample is usable.
        joined: (N - 1,), whether a row and the next are one regular step apart; all by default.
    """
    joined = np.ones(max(0, len(values) - 1), dtype=bool) if joined is None else joined
    whole = _difference_noise(values, joined)
    if whole is None or len(values) < BLOCKS * MIN_BLOCK_ROWS:
        return whole
    without = [_difference_noise(others, joined) for others in without_blocks(values)]
    known = [(noise.sd, noise.correlation) for noise in without if noise is not None]
    if len(known) < BLOCKS:
        return whole
    sd_error, correlation_error = jackknife_error(known).tolist()
    return replace(whole, sd_error=sd_error, correlation_error=correlation_error)


def without_blocks(values: Array) -> Iterator[Array]:
    """Yield values (N,) with NaN in each block of successive ones in turn, for `jackknife_error`."""
    edges = np.linspace(0, len(values), BLOCKS + 1).astype(int)
    for begin, end in pairwise(edges.tolist()):
        others = values.copy()
        others[begin:end] = np.nan
        yield others


def jackknife_error(estimates: Sequence[Sequence[float]]) -> Array:
    """Return the standard errors (k,) of k numbers, from estimates of them without each block in turn."""
    return np.std(np.array(estimates), axis=0) * sqrt(BLOCKS - 1)


def _difference_noise(values: Array, joined: Mask) -> Noise | None:
    one, two = (_second_differences(values, joined, k) for k in (1, 2))
    rows = int(np.count_nonzero(np.isfinite(two)))
    if rows < MIN_ROWS:
        return None
    near, far = trimmed_variance(one), trimmed_variance(two)
    if near == 0.0:
        return Noise(0.0, 0.0, rows)
    correlation = _correlation(far / near)
    variance = near / (2.0 * (1.0 - correlation) * (3.0 - correlation))
    return Noise(sqrt(variance), correlation, rows)


def _second_differences(values: Array, joined: Mask, k: int) -> Array:
    """Return the second differences over k rows, without those across a gap."""
    if len(values) <= 2 * k:
        return np.empty(0)
    breaks = np.concatenate([[0], np.cumsum(~joined)])
    whole = breaks[2 * k :] == breaks[: -2 * k]
    return (values[: -2 * k] - 2.0 * values[k:-k] + values[2 * k :])[whole]


def _correlation(ratio: float) -> float:
    """Return p with (1 + p)(3 - p^2)/(3 - p) = ratio by bisection, within +-0.98."""
    low, high = -MAX_CORRELATION, MAX_CORRELATION
    for _ in range(50):
        p = 0.5 * (low + high)
        if (1.0 + p) * (3.0 - p * p) / (3.0 - p) < ratio:
            low = p
        else:
            high = p
    return 0.5 * (low + high)


def noise_of_repeats(values: Array, conditions: Sequence[Hashable]) -> Noise | None:
    """Return the noise of rows (N,) with the same conditions (N,), without NaN; None below 8 degrees of freedom."""
    groups: dict[Hashable, list[float]] = {}
    for value, condition in zip(values.tolist(), conditions, strict=True):
        if np.isfinite(value):
            groups.setdefault(condition, []).append(value)
    deviates = [_independent(np.array(group)) for group in groups.values() if len(group) > 1]
    freedom = sum(len(deviate) for deviate in deviates)
    if freedom < MIN_ROWS:
        return None
    return Noise(sqrt(trimmed_variance(np.concatenate(deviates))), 0.0, freedom)


def _independent(group: Array) -> Array:
    """Return n values with an unknown mean as n - 1 independent deviates about zero of the same variance (Helmert)."""
    n = np.arange(1, len(group))
    before = np.cumsum(group)[:-1] / n
    return (group[1:] - before) * np.sqrt(n / (n + 1.0))

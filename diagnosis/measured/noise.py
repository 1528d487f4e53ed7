"""Noise of a channel from the channel itself: standard deviation, and correlation of a sample with the next.

Three estimators, for three kinds of data. All use a trimmed variance, the mean of the smallest 80 % of the squares over
its expectation for a normal deviate, so that a few wild samples count little. One of them spoils three second
differences: one in twenty makes the standard deviation from differences some 30 % too large.

*Differences*, for a smooth signal sampled often. With noise of variance s^2 whose correlation over k rows is p^k
(AR(1)), the second difference over k rows, x[i-k] - 2 x[i] + x[i+k], has the variance s^2 (6 - 8 p^k + 2 p^2k) and no
share of any straight line. The ratio of those at k = 2 and k = 1 is (1 + p)(3 - p^2)/(3 - p), which rises with p from
0 to 2 and gives p; then s follows. What the signal bends within two rows counts as noise, which most often makes
both too large; they are estimates and no bounds. P near 1 cannot be told from a slow signal. Of a reading in steps
that are coarse beside its noise, most differences are 0, and the estimate falls to 0 with them: `screening.noise_of`
keeps it above what rounding alone makes.

*Repeats*, for rows under the same conditions: pure error (Draper and Smith, Applied Regression Analysis, 3rd ed.,
section 2.1). A group of n rows gives n - 1 independent deviates by Helmert's contrasts.

*Residuals*, for what is left of a model: the variances of sum and difference of neighbours are 2 s^2 (1 + p) and
2 s^2 (1 - p) (Gnanadesikan and Kettenring, Biometrics 28 (1972) 81-124).
"""

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import log, sqrt
from statistics import NormalDist

import numpy as np

from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array

KEPT = 0.8
"""Share of the squares that a trimmed variance keeps."""
BLOCKS = 8
FEWEST_IN_BLOCK = 40
"""Rows, below which leaving a block out tells no error."""
FEWEST = 8
_STRONGEST = 0.98
SLOW = 0.9


@dataclass(frozen=True)
class Noise:
    sd: float
    correlation: float
    """Of a sample with the next; 0 where it was not asked for."""
    rows: int
    """Squares that went into it."""
    sd_error: float | None = None
    """Standard error by the jackknife, each eighth of the rows left out in turn; None with too few rows."""
    correlation_error: float | None = None
    is_resolved: bool = True
    """False where the readings come in steps too coarse for it: then `sd` is that of rounding, step over root 12."""

    @property
    def is_separable(self) -> bool:
        """Whether it can be told from a slow signal at all: correlated nearly to 1, within two
        standard errors, it is bent signal more likely.
        """
        return self.correlation + 2.0 * (self.correlation_error or 0.0) < SLOW

    def correlation_time_s(self, period_s: float) -> float:
        """After which the correlation has fallen to 1/e; 0 where neighbours are not correlated, or oppositely."""
        return -period_s / log(self.correlation) if self.correlation > 0.0 else 0.0


def trimmed_variance(deviations: Array) -> float:
    """About zero, of normal deviates with a few wild ones among them; NaN are left out, NaN for none."""
    squares = np.sort(deviations[np.isfinite(deviations)] ** 2)
    if not len(squares):
        return float("nan")
    kept = max(1, round(KEPT * len(squares)))
    return float(np.mean(squares[:kept])) / mean_of_smallest_squares(kept / len(squares))


def mean_of_smallest_squares(share: float) -> float:
    """Mean of the smallest squares of a standard normal deviate: 1 - 2 c pdf(c) / share with 2 cdf(c) - 1 = share."""
    if share >= 1.0:
        return 1.0
    normal = NormalDist()
    bound = normal.inv_cdf(0.5 + 0.5 * share)
    return 1.0 - 2.0 * bound * normal.pdf(bound) / share


def noise_of_differences(values: Array, joined: Mask | None = None) -> Noise | None:
    """Of a smooth channel.

    Args:
        values: (N,), NaN where nothing usable was measured.
        joined: (N - 1,), whether a row and the next are one regular step apart; all by default.

    Returns:
        None with fewer than 8 second differences over two rows.
    """
    return _with_errors(_of_differences, values, joined)


def _of_differences(values: Array, joined: Mask) -> Noise | None:
    one, two = (_second_differences(values, joined, k) for k in (1, 2))
    rows = int(np.count_nonzero(np.isfinite(two)))
    if rows < FEWEST:
        return None
    near, far = trimmed_variance(one), trimmed_variance(two)
    if near == 0.0:
        return Noise(0.0, 0.0, rows)
    correlation = _correlation(far / near)
    variance = near / (2.0 * (1.0 - correlation) * (3.0 - correlation))
    return Noise(sqrt(variance), correlation, rows)


def _second_differences(values: Array, joined: Mask, k: int) -> Array:
    """Over k rows, without those that reach across a gap."""
    if len(values) <= 2 * k:
        return np.empty(0)
    breaks = np.concatenate([[0], np.cumsum(~joined)])
    whole = breaks[2 * k :] == breaks[: -2 * k]
    return (values[: -2 * k] - 2.0 * values[k:-k] + values[2 * k :])[whole]


def _correlation(ratio: float) -> float:
    """P of (1 + p)(3 - p^2)/(3 - p) = ratio, within +-0.98."""
    low, high = -_STRONGEST, _STRONGEST
    for _ in range(50):
        p = 0.5 * (low + high)
        if (1.0 + p) * (3.0 - p * p) / (3.0 - p) < ratio:
            low = p
        else:
            high = p
    return 0.5 * (low + high)


def noise_of_residuals(residuals: Array, joined: Mask | None = None) -> Noise | None:
    """Of what a model leaves of a channel; arguments as those of `noise_of_differences`."""
    return _with_errors(_of_residuals, residuals, joined)


def _of_residuals(residuals: Array, joined: Mask) -> Noise | None:
    rows = int(np.count_nonzero(np.isfinite(residuals)))
    if rows < FEWEST:
        return None
    sum_ = trimmed_variance((residuals[1:] + residuals[:-1])[joined])
    difference = trimmed_variance((residuals[1:] - residuals[:-1])[joined])
    both = sum_ + difference
    correlation = (sum_ - difference) / both if both > 0.0 else 0.0
    return Noise(sqrt(trimmed_variance(residuals)), correlation, rows)


def _with_errors(estimate: Callable[[Array, Mask], Noise | None], values: Array, joined: Mask | None) -> Noise | None:
    joined = np.ones(max(0, len(values) - 1), dtype=bool) if joined is None else joined
    whole = estimate(values, joined)
    if whole is None or len(values) < BLOCKS * FEWEST_IN_BLOCK:
        return whole
    edges = np.linspace(0, len(values), BLOCKS + 1).astype(int)
    without = []
    for begin, end in pairwise(edges.tolist()):
        others = values.copy()
        others[begin:end] = np.nan
        noise = estimate(others, joined)
        if noise is None:
            return whole
        without.append((noise.sd, noise.correlation))
    scatter = np.std(np.array(without), axis=0) * sqrt(BLOCKS - 1)
    return Noise(whole.sd, whole.correlation, whole.rows, float(scatter[0]), float(scatter[1]))


def noise_of_repeats(values: Array, conditions: Sequence[Hashable]) -> Noise | None:
    """Of rows under the same conditions, (N,) each; NaN are left out. None with fewer than 8 degrees of freedom."""
    groups: dict[Hashable, list[float]] = {}
    for value, condition in zip(values.tolist(), conditions, strict=True):
        if np.isfinite(value):
            groups.setdefault(condition, []).append(value)
    deviates = [_independent(np.array(group)) for group in groups.values() if len(group) > 1]
    freedom = sum(len(deviate) for deviate in deviates)
    if freedom < FEWEST:
        return None
    return Noise(sqrt(trimmed_variance(np.concatenate(deviates))), 0.0, freedom)


def _independent(group: Array) -> Array:
    """N values with a mean of their own as n - 1 independent deviates of the same variance about zero (Helmert)."""
    n = np.arange(1, len(group))
    before = np.cumsum(group)[:-1] / n
    return (group[1:] - before) * np.sqrt(n / (n + 1.0))

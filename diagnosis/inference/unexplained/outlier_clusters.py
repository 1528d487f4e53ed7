"""Outliers that gather at neighbouring values of a covariate.

A fit with outliers takes readings that are far off for mistakes of the logger. Such mistakes happen anywhere: which
rows they hit does not depend on the speed or the distance. If most of them lie in a narrow range of a covariate and on
the same side, they are no mistakes, but what the model lacks there. Given the number of outliers, the number of them in
a range has a hypergeometric distribution (Fisher's exact test), and the best of all ranges is taken (scan statistic:
Glaz, Naus and Wallenstein, Scan Statistics, 2001), so that its probability is multiplied by their number.

In a series, a few wild readings in a row are one mistake of the logger. While a robot drives straight on, they also lie
at neighbouring values of its heading, which says nothing about the heading; so each such run counts once.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import comb

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln

from diagnosis.inference.unexplained.bases import OUTLIERS_IN_A_ROW, SHARE_OF_SIGN
from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import Covariate, CovariateShape
from symolo.core.arrays import Array

FAR = 4.0
"""Residual in sigmas from which a reading counts as an outlier."""
MIN_OUTLIERS = 3
"""Smallest number of outliers in a range."""
MAX_OPPOSITE = 0.125
"""Largest number of outliers of the other side in the range, for each of this one. Where readings scatter more, there
are outliers of both sides."""
CANDIDATES = 32
"""Number of ranges whose probability is computed exactly: those that are the least likely by its largest term."""
APART = 2
"""Distance in rows beyond which two outliers are of different runs."""
MAX_SHARE = 0.25
"""Largest share of outliers; with more of them, they are no outliers, and other tests see what they are."""


@dataclass(frozen=True)
class Cluster:
    """Outliers in a range of a covariate."""

    rows: Mask
    """(n,), the outliers, of one side."""
    p: float
    """Probability that chance gathers as many, over all ranges of the covariate and both sides."""


def cluster(z: Array, covariate: Covariate, rows: Mask, trial: NDArray[np.int64] | None = None) -> Cluster | None:
    """Return the most improbable cluster of outliers along a covariate; None if there is none.

    Args:
        z: (n,), residuals in sigmas.
        covariate: A covariate of n rows.
        rows: (n,), rows of the fit.
        trial: (n,), trial of each row of a series; None if the rows do not follow each other.
    """
    known = rows & np.isfinite(covariate.values)
    sign = np.where(known, _sides(z), 0.0)
    if trial is not None:
        for run in short_runs(sign.copy(), trial):
            sign[run[1:]] = 0.0
    outliers = int(np.count_nonzero(sign[known]))
    if outliers < MIN_OUTLIERS or outliers > MAX_SHARE * np.count_nonzero(known) or covariate.second is not None:
        return None
    views = list(_views(covariate, known, sign))
    best: Cluster | None = None
    for values, along in views:
        for direction in (-1.0, 1.0):
            sides = known & (along == direction), known & (along == -direction)
            p, members = _densest(values, known, sides, covariate.shape is CovariateShape.CATEGORY)
            p = min(1.0, 2.0 * len(views) * p)
            if members is not None and (best is None or p < best.p):
                best = Cluster(members, p)
    return best


def short_runs(sign: Array, trial: NDArray[np.int64]) -> Iterator[NDArray[np.intp]]:
    """Yield the places of the outliers of each run on one side, single ones too, that a logger may cause.

    Args:
        sign: (n,), sides of the outliers; 0 for other rows.
        trial: (n,), trial of each row.
    """
    for direction in (-1.0, 1.0):
        places = np.flatnonzero(sign == direction)
        apart = (np.diff(places) > APART) | (np.diff(trial[places]) != 0)
        yield from (run for run in np.split(places, 1 + np.flatnonzero(apart)) if 0 < len(run) <= OUTLIERS_IN_A_ROW)


def wild(z: Array, trial: NDArray[np.int64]) -> Mask:
    """Return the readings (n,) that are far off in a short run: what a logger may cause."""
    rows = np.zeros(len(z), dtype=bool)
    for run in short_runs(_sides(z), trial):
        rows[run] = True
    return rows


def begins(wild_rows: Mask) -> Mask:
    """Return the rows (n,) that are not wild or begin a run of successive wild rows."""
    return ~(wild_rows & np.append(False, wild_rows[:-1]))


def _sides(z: Array) -> Array:
    """Return the side (n,) of each residual that is an outlier; 0 for the others."""
    return np.where(np.abs(z) > FAR, np.sign(z), 0.0)


def _views(covariate: Covariate, known: Mask, sign: Array) -> Iterator[tuple[Array, Array]]:
    """Yield the values of a covariate and the sides of the outliers; then both against the sign of the covariate.

    An outline has no beginning, so that it is cut at two places.
    """
    values = covariate.values
    yield values, sign
    if covariate.shape is CovariateShape.OUTLINE:
        length, half = covariate.corners[-1], covariate.corners[len(covariate.corners) // 2]
        yield np.mod(values - half, length), sign
    elif covariate.shape is not CovariateShape.CATEGORY:
        shares = np.mean(values[known] < 0.0), np.mean(values[known] > 0.0)
        if min(shares) >= SHARE_OF_SIGN:
            yield np.abs(values), sign * np.sign(values)


def _densest(
    values: Array,
    known: Mask,
    sides: tuple[Mask, Mask],
    is_category: bool,  # noqa: FBT001
) -> tuple[float, Mask | None]:
    """Return the probability of the densest range and its members (n,); 1 and None if there is none.

    Args:
        values: (n,), values of the covariate.
        known: (n,), rows that count.
        sides: (n,) each, outliers of one side, and of the other.
        is_category: Whether the values are only names.
    """
    hit, opposite = sides
    ordered = np.sort(values[known])
    at, others = np.sort(values[hit]), np.sort(values[opposite])
    ends = np.unique(at) if is_category else at
    first, last = np.triu_indices(len(ends))
    if is_category:
        first, last = first[first == last], last[first == last]
    low, high = ends[first], ends[last]
    inside, against, length = (_between(sorted_values, low, high) for sorted_values in (at, others, ordered))
    total, outliers = len(ordered), len(at)
    # Where a range has no more outliers than its share of the rows, chance has as many.
    dense = (inside >= MIN_OUTLIERS) & (against <= MAX_OPPOSITE * inside) & (inside * total > length * outliers)
    inside, length, low, high = inside[dense], length[dense], low[dense], high[dense]
    ranges = np.full(len(length), len(np.unique(ordered))) if is_category else total - length + 1
    likely = np.log(ranges) + _log_exactly(inside, length, outliers, total)
    best: tuple[float, Mask | None] = (1.0, None)
    for k in np.argsort(likely, kind="stable")[:CANDIDATES].tolist():
        p = min(1.0, int(ranges[k]) * _at_least(int(inside[k]), int(length[k]), outliers, total))
        if p < best[0]:
            best = p, hit & (values >= low[k]) & (values <= high[k])
    return best


def _between(ordered: Array, low: Array, high: Array) -> NDArray[np.int64]:
    """Return how many of sorted values lie in each range (m,), with its ends."""
    return np.searchsorted(ordered, high, "right") - np.searchsorted(ordered, low, "left")


def _log_exactly(inside: NDArray[np.int64], length: NDArray[np.int64], outliers: int, total: int) -> Array:
    """Return the logarithm of the probability (m,) that exactly `inside` of the outliers are among `length` rows.

    It is nearly that of at least as many where it is small, and costs no sum.
    """
    rest = total - length
    return _log_ways(length, inside) + _log_ways(rest, outliers - inside) - _log_ways(total, outliers)


def _log_ways(n: NDArray[np.int64] | int, k: NDArray[np.int64] | int) -> Array:
    """Return the logarithm of the binomial coefficient of n and k."""
    return gammaln(np.add(n, 1)) - gammaln(np.add(k, 1)) - gammaln(np.subtract(n, k) + 1)


def _at_least(inside: int, length: int, outliers: int, total: int) -> float:
    """Return the probability that at least `inside` of `outliers` of `total` rows are among `length` given ones."""
    ways = sum(comb(length, k) * comb(total - length, outliers - k) for k in range(inside, min(length, outliers) + 1))
    return ways / comb(total, outliers)

"""Outliers that gather at neighbouring values of a covariate.

A fit with outliers takes readings that are far off for mistakes of the logger. Such mistakes happen anywhere: which
rows they hit does not depend on the speed or the distance. If most of them lie in a narrow range of a covariate and on
the same side, they are no mistakes, but what the model lacks there. Given the number of outliers, the number of them in
a range has a hypergeometric distribution (Fisher's exact test), and the best of all ranges is taken (scan statistic:
Glaz, Naus and Wallenstein, Scan Statistics, 2001), so that its probability is multiplied by their number.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import comb

import numpy as np

from diagnosis.inference.unexplained.bases import SHARE_OF_SIGN
from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import Covariate, CovariateShape
from symolo.core.arrays import Array

FAR = 4.0
"""Residual in sigmas from which a reading counts as an outlier."""
MIN_OUTLIERS = 3
"""Least number of outliers in a range."""
MAX_OPPOSITE = 0.125
"""Greatest number of outliers of the other side in the range, for each of this one. Where readings scatter more, there
are outliers of both sides."""
MAX_SHARE = 0.25
"""Greatest share of outliers; with more of them, they are no outliers, and other tests see what they are."""


@dataclass(frozen=True)
class Cluster:
    """Outliers in a range of a covariate."""

    rows: Mask
    """(n,), the outliers, of one side."""
    p: float
    """Probability that chance gathers as many, over all ranges of the covariate and both sides."""


def cluster(z: Array, covariate: Covariate, rows: Mask) -> Cluster | None:
    """Return the most improbable cluster of outliers along a covariate; None if there is none.

    Args:
        z: (n,), residuals in sigmas.
        covariate: A covariate of n rows.
        rows: (n,), rows of the fit.
    """
    known = rows & np.isfinite(covariate.values)
    sign = np.where(np.abs(z) > FAR, np.sign(z), 0.0)
    outliers = int(np.count_nonzero(sign[known]))
    if outliers < MIN_OUTLIERS or outliers > MAX_SHARE * np.count_nonzero(known) or covariate.second is not None:
        return None
    views = list(_views(covariate, known, sign))
    best: Cluster | None = None
    for values, along in views:
        for side in (-1.0, 1.0):
            sides = known & (along == side), known & (along == -side)
            p, members = _densest(values, known, sides, covariate.shape is CovariateShape.CATEGORY)
            p = min(1.0, 2.0 * len(views) * p)
            if members is not None and (best is None or p < best.p):
                best = Cluster(members, p)
    return best


def _views(covariate: Covariate, known: Mask, sign: Array) -> Iterator[tuple[Array, Array]]:
    """Yield the values of a covariate and the sides of the outliers; then both against the sign of the covariate."""
    values = covariate.values
    yield values, sign
    if covariate.shape is not CovariateShape.CATEGORY:
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
    at = np.unique(values[hit]) if is_category else np.sort(values[hit])
    total, outliers = len(ordered), int(np.count_nonzero(hit))
    best: tuple[float, Mask | None] = (1.0, None)
    for i, low in enumerate(at.tolist()):
        for high in [low] if is_category else at[i:].tolist():
            members = hit & (values >= low) & (values <= high)
            inside = int(np.count_nonzero(members))
            against = int(np.count_nonzero(opposite & (values >= low) & (values <= high)))
            if inside < MIN_OUTLIERS or against > MAX_OPPOSITE * inside:
                continue
            length = int(np.searchsorted(ordered, high, "right") - np.searchsorted(ordered, low, "left"))
            ranges = len(np.unique(ordered)) if is_category else total - length + 1
            p = min(1.0, ranges * _at_least(inside, length, outliers, total))
            if p < best[0]:
                best = p, members
    return best


def _at_least(inside: int, length: int, outliers: int, total: int) -> float:
    """Return the probability that at least `inside` of `outliers` of `total` rows are among `length` given ones."""
    ways = sum(comb(length, k) * comb(total - length, outliers - k) for k in range(inside, min(length, outliers) + 1))
    return ways / comb(total, outliers)

"""Flexible functions of a covariate, as columns: what a residual could look like if nothing were known of its cause."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import Covariate, CovariateShape
from symolo.core.arrays import Array

KNOTS = 8
FEW_KNOTS = 4
FEW_ROWS = 30
SHARE_OF_SIGN = 0.1
"""Of the rows, at least, either way, for a covariate with a sign."""
SINCE_KNOTS = 16
"""At times since an event, each as many times later than the one before."""
HARMONICS = 3
"""Of a turn, together; the higher ones are looked at one by one."""
HIGHEST_HARMONIC = 12
RADIANS_PER_ROW = 2.0
"""Of a wave, at most, for the rows to show it: a good third of a cycle."""
RUNS = (4, 6, 8, 12, 16, 24)
"""Rows that may stand out together."""
MAX_RUNS = 16
RUNS_OF_ROWS = "runs of rows"
ROWS_FOR_RUNS = 60
JUMPS = 40
"""Steps at quantiles, among any functions."""
CATEGORIES = 30
"""Beyond these, categories are as good as rows."""
CELLS = 4
"""Along each side of a place's grid."""
MIN_ROWS = 4
"""That a column must be about."""
SCANNED_ROWS = 24
"""From which waves are looked for."""
WAVES_IN_RANGE = (1.5, 40.0)
"""Of a covariate's range, fewest and most."""


@dataclass(frozen=True)
class Basis:
    """Columns (n, k), over the rows where the covariate is known; 0 elsewhere."""

    columns: Array
    what: str
    """Such as `trend` or `wave of LENGTH`, for reports."""
    tries: int = 1
    """Bases of which this is one, all looked at."""


def bases(covariate: Covariate, rows: Mask) -> Iterator[Basis]:
    """Of a covariate, over some of its rows."""
    values = covariate.values[rows]
    known = np.isfinite(values)
    if np.count_nonzero(known) < 2 * MIN_ROWS:
        return
    if covariate.second is not None:
        yield from _kept(_grid(values, covariate.second[rows]), "place")
    elif covariate.shape is CovariateShape.CATEGORY:
        names = np.unique(values[known])
        if 2 <= len(names) <= CATEGORIES:
            yield from _kept(np.where(known[:, None], values[:, None] == names, 0.0).astype(float), "category")
    elif covariate.shape is CovariateShape.PERIODIC:
        yield from _turns(covariate, rows)
    else:
        yield from _kept(_hats(values, known, _quantiles(values[known])), "trend")
        if min(np.mean(values[known] < 0.0), np.mean(values[known] > 0.0)) >= SHARE_OF_SIGN:
            yield from _kept(_odd(values, known), "trend, either way")
        if covariate.shape is CovariateShape.SINCE:
            yield from _kept(_settling(covariate, rows), "settling")
        yield from _waves(values, known)


def any_function(covariate: Covariate, rows: Mask) -> Array:
    """Columns (n, k) that come near any function of a covariate, jumps and waves too, to stand beside a named effect.

    Over all samples, 0 where the covariate is not known and at rows that are not asked for.
    """
    found = [basis.columns for basis in bases(covariate, rows) if basis.tries == 1]
    if covariate.shape in {CovariateShape.SMOOTH, CovariateShape.SINCE} and covariate.second is None:
        values = covariate.values[rows]
        known = np.isfinite(values)
        edges = np.unique(np.quantile(values[known], np.linspace(0.0, 1.0, JUMPS + 1)[1:-1])) if known.any() else []
        found.append(np.where(known[:, None], values[:, None] >= np.array(edges), 0.0).astype(float))
    columns = np.zeros((len(rows), sum(part.shape[1] for part in found)))
    columns[rows] = np.concatenate(found, axis=1) if found else 0.0
    return columns


def _kept(columns: Array, what: str) -> Iterator[Basis]:
    about = np.count_nonzero(np.abs(columns) > 1e-9, axis=0) >= MIN_ROWS
    if about.any():
        yield Basis(columns[:, about], what)


def _turns(covariate: Covariate, rows: Mask) -> Iterator[Basis]:
    """Sines and cosines of an angle: of the first harmonics together, then of each higher one that the rows show."""
    values = covariate.values[rows]
    known = np.isfinite(values)
    size = None if covariate.size is None else covariate.size[rows, None]
    step = float(np.quantile(np.abs(np.diff(values[known])), 0.9))
    highest = min(HIGHEST_HARMONIC, int(RADIANS_PER_ROW / max(step, 1e-9)))
    higher = range(HARMONICS + 1, highest + 1)
    lowest = (np.arange(1, HARMONICS + 1), "turn", 1)
    each = [(np.array([n]), f"harmonic {n} of a turn", len(higher) * (1 if size is None else 2)) for n in higher]
    for orders, what, tries in (lowest, *each):
        angle = np.where(known, values, 0.0)[:, None] * orders
        columns = _where(known, np.concatenate([np.cos(angle), np.sin(angle)], axis=1))
        for basis in _kept(columns, what):
            yield replace(basis, tries=tries)
        if size is not None:
            for basis in _kept(columns * size, f"{what}, times the speed"):
                yield replace(basis, tries=tries)


def standing_out(left: Array, trial: NDArray[np.int64]) -> Iterator[Basis]:
    """A few runs of rows whose residuals stand out together: the one that does most, the two, the four, and so on.

    A single row that stands out is an outlier, as any log has; several in a row have a cause that lasts. Each basis
    counts as all sets of so many runs, of either sign, of which it is one.

    Args:
        left: (n,), residuals, clipped.
        trial: (n,), which trial a row is of; a run lies in one.
    """
    if len(left) < ROWS_FOR_RUNS:
        return
    total = np.append(0.0, np.cumsum(left))
    begins, lengths, means = [], [], []
    for length in RUNS:
        begin = np.flatnonzero(trial[length - 1 :] == trial[: len(trial) - length + 1])
        begins.append(begin)
        lengths.append(np.full(len(begin), length))
        means.append((total[begin + length] - total[begin]) / length)
    begin, length, mean = np.concatenate(begins), np.concatenate(lengths), np.concatenate(means)
    square = length * mean**2
    column = np.zeros(len(left))
    for count in range(1, MAX_RUNS + 1):
        run = int(np.argmax(square))
        if square[run] <= 0.0:
            return
        first, last = int(begin[run]), int(begin[run] + length[run])
        column[first:last] = mean[run]
        square[(begin < last) & (begin + length > first)] = 0.0
        if count.bit_count() == 1:  # 1, 2, 4, ...
            tries = math.comb(len(begin), count) * 2**count
            yield Basis(column[:, None].copy(), RUNS_OF_ROWS, tries)


def _where(known: Mask, columns: Array) -> Array:
    """The columns, 0 in rows where the covariate is not known."""
    return np.where(known[:, None], columns, 0.0)


def _quantiles(given: Array) -> Array:
    knots = KNOTS if len(given) >= FEW_ROWS else FEW_KNOTS
    return np.unique(np.quantile(given, np.linspace(0.0, 1.0, knots)))


def _ever_later(given: Array) -> Array:
    times = np.unique(given[given > 0.0])
    if len(times) < SINCE_KNOTS:
        return times
    return np.append(0.0, np.geomspace(times[0], times[-1], SINCE_KNOTS))


def _settling(covariate: Covariate, rows: Mask) -> Array:
    values = covariate.values[rows]
    known = np.isfinite(values)
    size = np.ones(len(values)) if covariate.size is None else covariate.size[rows]
    return _hats(values, known, _ever_later(values[known])) * np.where(known, size, 0.0)[:, None]


def _odd(values: Array, known: Mask) -> Array:
    """Of a friction, say, that is against the motion either way: as fine on one side as any function on both."""
    size = np.abs(values)
    return _hats(size, known, _quantiles(size[known])) * np.where(known, np.sign(values), 0.0)[:, None]


def _hats(values: Array, known: Mask, places: Array) -> Array:
    """Linear B-splines on knots."""
    if len(places) < 2:
        return np.zeros((len(values), 0))
    at = np.where(known, values, places[0])
    return _where(known, np.stack([np.interp(at, places, row) for row in np.eye(len(places))], axis=1))


def _grid(x: Array, y: Array) -> Array:
    """Products of hats along both coordinates of a place."""
    known = np.isfinite(x) & np.isfinite(y)
    sides = []
    for values in (x, y):
        places = np.linspace(values[known].min(), values[known].max() + 1e-9, CELLS)
        sides.append(np.stack([np.interp(np.where(known, values, 0.0), places, row) for row in np.eye(CELLS)], axis=1))
    along, across = sides
    return _where(known, (along[:, :, None] * across[:, None, :]).reshape(len(x), -1))


def _waves(values: Array, known: Mask) -> Iterator[Basis]:
    """Sine and cosine of each wavelength that the rows can show."""
    given = values[known]
    distinct = len(np.unique(given))
    reach = float(np.ptp(given))
    if len(given) < SCANNED_ROWS or distinct < SCANNED_ROWS / 2 or reach <= 0.0:
        return
    most = min(WAVES_IN_RANGE[1], distinct / 3.0)
    counts = np.arange(WAVES_IN_RANGE[0], most, 0.5)
    for count in counts.tolist():
        angle = 2.0 * np.pi * count * np.where(known, values, 0.0) / reach
        columns = _where(known, np.stack([np.cos(angle), np.sin(angle)], axis=1))
        yield Basis(columns, f"wave of {reach / count:.3g}", tries=len(counts))

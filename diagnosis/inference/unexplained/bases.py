"""Flexible functions of a covariate as columns: the shapes of a residual whose cause is unknown."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import Covariate, CovariateShape
from symolo.core.arrays import Array

KNOTS = 8
FEW_KNOTS = 4
FEW_ROWS = 30
SHARE_OF_SIGN = 0.1
"""Share of the rows with either sign, from which a covariate counts as signed."""
SINCE_KNOTS = 16
"""Knots at times since an event, in geometric progression."""
HARMONICS = 3
"""Harmonics of a turn that are tested together; higher ones are tested one by one."""
HIGHEST_HARMONIC = 12
RADIANS_PER_ROW = 2.0
"""Largest phase of a wave from row to row at which the rows show it: about a third of a cycle."""
RUNS = (4, 6, 8, 12, 16, 24)
"""Numbers of successive rows that may stand out together."""
OUTLIERS_IN_A_ROW = 8
"""Number of successive rows up to which outliers may come from the logger. They are reported as unexplained, but do not
speak against effects, which act in all rows. GAP_FORMAT has runs of up to six; a run is found with a few rows more."""
MAX_RUNS = 16
RUNS_OF_ROWS = "runs of rows"
RUNS_OF_OUTLIERS = "runs of outliers"
ROWS_FOR_RUNS = 60
JUMPS = 40
"""Steps at quantiles, for `any_function`."""
CATEGORIES = 30
"""Largest number of categories; more are hardly different from single rows."""
CELLS = 4
"""Cells along each side of the grid of a place."""
MIN_ROWS = 4
"""Rows in which a column must differ from zero."""
SCANNED_ROWS = 24
"""Rows from which waves are tested."""
MIN_WAVES = 1.5
"""Smallest number of waves within the range of a covariate."""
MIN_ROWS_PER_WAVE = 2.0
"""Smallest mean number of distinct values in a wave, as at the Nyquist frequency; values of a bench are mostly uneven,
and then show even shorter waves."""
WITH_COVARIATE = ", changing sign with it"
"""End of the description of a dependence that is odd in the covariate."""


@dataclass(frozen=True)
class Basis:
    """Columns (n, k), over the rows where the covariate is known; 0 elsewhere."""

    columns: Array
    what: str
    """Description for reports, such as `trend` or `wave of LENGTH`."""
    tries: int = 1
    """Number of bases that are tested, of which this is one."""
    is_of_outliers: bool = False
    """Whether the basis consists of runs of rows so short that a logger may cause them."""


def bases(covariate: Covariate, rows: Mask) -> Iterator[Basis]:
    """Yield the bases of a covariate over some of its rows."""
    values = covariate.values[rows]
    known = np.isfinite(values)
    if np.count_nonzero(known) < 2 * MIN_ROWS:
        return
    if covariate.second is not None:
        grid = _grid(values, covariate.second[rows])
        yield from _enough(grid, "place")
        if covariate.size is not None:
            yield from _enough(grid * covariate.size[rows, None], "place, with the sign of the motion")
        yield from _computed(covariate, rows)
    elif covariate.shape is CovariateShape.CATEGORY:
        names = np.unique(values[known])
        if 2 <= len(names) <= CATEGORIES:
            yield from _enough(np.where(known[:, None], values[:, None] == names, 0.0).astype(float), "category")
    elif covariate.shape is CovariateShape.PERIODIC:
        yield from _turns(covariate, rows)
    elif covariate.shape is CovariateShape.EVENT:
        yield from _events(covariate, rows)
    elif covariate.shape is CovariateShape.COMPUTED:
        yield from _computed(covariate, rows)
    elif covariate.shape is CovariateShape.OUTLINE:
        yield from _enough(_along_outline(covariate, rows), "outline")
    else:
        yield from _smooth(covariate, rows)


def _smooth(covariate: Covariate, rows: Mask) -> Iterator[Basis]:
    """Yield curves of a covariate, and its waves."""
    values = covariate.values[rows]
    known = np.isfinite(values)
    is_load = covariate.shape is CovariateShape.SMOOTH and covariate.size is not None
    if not is_load:
        yield from _enough(_hats(values, known, _quantiles(values[known])), "trend")
    if min(np.mean(values[known] < 0.0), np.mean(values[known] > 0.0)) >= SHARE_OF_SIGN:
        yield from _enough(_odd(values, known), f"trend{WITH_COVARIATE}")
    if is_load and covariate.size is not None:
        # A load acts against the motion, so that no other curve of a covariate with a size has a meaning.
        hats = _hats(np.abs(values), known, _quantiles(np.abs(values[known])))
        yield from _enough(hats * covariate.size[rows, None], "trend, in proportion to the motion")
    if covariate.shape is CovariateShape.SINCE:
        yield from _enough(_settling(covariate, rows), "settling")
    yield from _waves(values, known, covariate.max_waves)


def any_function(covariate: Covariate, rows: Mask) -> Array:
    """Return columns (n, k) that approximate any function of a covariate, with jumps and waves.

    They are 0 where the covariate is not known, and outside `rows`.
    """
    parts = [basis.columns for basis in bases(covariate, rows) if basis.tries == 1]
    if covariate.shape in {CovariateShape.SMOOTH, CovariateShape.SINCE} and covariate.second is None:
        values = covariate.values[rows]
        known = np.isfinite(values)
        edges = np.unique(np.quantile(values[known], np.linspace(0.0, 1.0, JUMPS + 1)[1:-1])) if known.any() else []
        parts.append(np.where(known[:, None], values[:, None] >= np.array(edges), 0.0).astype(float))
    columns = np.zeros((len(rows), sum(part.shape[1] for part in parts)))
    columns[rows] = np.concatenate(parts, axis=1) if parts else 0.0
    return columns


def _enough(columns: Array, what: str) -> Iterator[Basis]:
    """Yield the basis of the columns that differ from zero in enough rows."""
    about = np.count_nonzero(np.abs(columns) > 1e-9, axis=0) >= MIN_ROWS
    if about.any():
        yield Basis(columns[:, about], what)


def _turns(covariate: Covariate, rows: Mask) -> Iterator[Basis]:
    """Yield sines and cosines of an angle: the first harmonics together, then each higher one that the rows show."""
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
        for basis in _enough(columns, what):
            yield replace(basis, tries=tries)
        if size is not None:
            for basis in _enough(columns * size, f"{what}, in proportion to the motion"):
                yield replace(basis, tries=tries)


def _events(covariate: Covariate, rows: Mask) -> Iterator[Basis]:
    """Yield the events of either sign that reach a size, for each size.

    Which events are large enough to matter is not known; a small one may be only a part of another motion.
    """
    levels = np.zeros((np.count_nonzero(rows), 0)) if covariate.levels is None else covariate.levels[rows]
    for level in levels.T:
        columns = np.stack([level > 0.0, level < 0.0], axis=1).astype(float)
        for basis in _enough(columns, "event"):
            yield replace(basis, tries=levels.shape[1])


def _computed(covariate: Covariate, rows: Mask) -> Iterator[Basis]:
    """Yield each set of functions that a stage has computed."""
    for functions in covariate.functions:
        for basis in _enough(functions[rows], covariate.functions_are):
            yield replace(basis, tries=len(covariate.functions))


def _along_outline(covariate: Covariate, rows: Mask) -> Array:
    """Return linear B-splines along each part of an outline, which may jump at the corners.

    With a size, they are multiplied by it, as the shift of a wall by what it does to a slanted beam.
    """
    values = covariate.values[rows]
    parts = []
    for begin, end in pairwise(covariate.corners):
        inside = np.isfinite(values) & (values >= begin) & (values < end)
        if np.count_nonzero(inside) >= 2 * MIN_ROWS:
            places = np.linspace(values[inside].min(), values[inside].max() + 1e-9, CELLS)
            parts.append(_hats(values, inside, places))
    columns = np.concatenate(parts, axis=1) if parts else np.zeros((len(values), 0))
    return columns if covariate.size is None else columns * covariate.size[rows, None]


def standing_out(residuals: Array, trial: NDArray[np.int64], wild: Mask, what: str) -> Iterator[Basis]:
    """Yield bases of runs of rows with large residuals: of the largest run, of the two largest, of four, and so on.

    A single row that stands out is an outlier, which any log has; several successive ones have a lasting cause. A basis
    counts as one of all sets of as many runs, with either sign. Runs of wild readings and other runs are sets apart:
    among sixteen runs, some are by chance as long as those of a lasting cause, which must not be what is wild.

    Args:
        residuals: (n,), residuals, clipped.
        trial: (n,), trial of each row; a run lies within one trial.
        wild: (n,), readings far off that a logger can cause.
        what: `RUNS_OF_OUTLIERS` for the runs of wild readings, `RUNS_OF_ROWS` for the runs of all others.
    """
    if len(residuals) < ROWS_FOR_RUNS:
        return
    counts = wild if what == RUNS_OF_OUTLIERS else ~wild
    total = np.append(0.0, np.cumsum(np.where(counts, residuals, 0.0)))
    begins, lengths, means = [], [], []
    for length in RUNS:
        begin = np.flatnonzero(trial[length - 1 :] == trial[: len(trial) - length + 1])
        begins.append(begin)
        lengths.append(np.full(len(begin), length))
        means.append((total[begin + length] - total[begin]) / length)
    begin, length, mean = np.concatenate(begins), np.concatenate(lengths), np.concatenate(means)
    square = length * mean**2
    by_chance = 2.0 * math.log(len(begin))
    column = np.zeros(len(residuals))
    longest = 0
    for count in range(1, MAX_RUNS + 1):
        run = int(np.argmax(square))
        if square[run] <= 0.0:
            return
        first, last = int(begin[run]), int(begin[run] + length[run])
        column[first:last] = np.where(counts[first:last], mean[run], 0.0)
        longest = max(longest, last - first if square[run] > by_chance else 0)
        square[(begin < last) & (begin + length > first)] = 0.0
        if count.bit_count() == 1:  # 1, 2, 4, ...
            tries = math.comb(len(begin), count) * 2**count
            is_of_outliers = what == RUNS_OF_OUTLIERS or 0 < longest <= OUTLIERS_IN_A_ROW
            yield Basis(column[:, None].copy(), what, tries, is_of_outliers)


def _where(known: Mask, columns: Array) -> Array:
    """Return the columns with 0 in rows where the covariate is not known."""
    return np.where(known[:, None], columns, 0.0)


def _quantiles(values: Array) -> Array:
    knots = KNOTS if len(values) >= FEW_ROWS else FEW_KNOTS
    return np.unique(np.quantile(values, np.linspace(0.0, 1.0, knots)))


def _settling_knots(times_s: Array) -> Array:
    times = np.unique(times_s[times_s > 0.0])
    if len(times) < SINCE_KNOTS:
        return times
    return np.append(0.0, np.geomspace(times[0], times[-1], SINCE_KNOTS))


def _settling(covariate: Covariate, rows: Mask) -> Array:
    values = covariate.values[rows]
    known = np.isfinite(values)
    size = np.ones(len(values)) if covariate.size is None else covariate.size[rows]
    return _hats(values, known, _settling_knots(values[known])) * np.where(known, size, 0.0)[:, None]


def _odd(values: Array, known: Mask) -> Array:
    """Return odd functions, such as a friction against the motion, with all knots on one side."""
    size = np.abs(values)
    return _hats(size, known, _quantiles(size[known])) * np.where(known, np.sign(values), 0.0)[:, None]


def _hats(values: Array, known: Mask, places: Array) -> Array:
    """Return linear B-splines on knots."""
    if len(places) < 2:
        return np.zeros((len(values), 0))
    at = np.where(known, values, places[0])
    return _where(known, np.stack([np.interp(at, places, row) for row in np.eye(len(places))], axis=1))


def _grid(x: Array, y: Array) -> Array:
    """Return products of linear B-splines along both coordinates of a place."""
    known = np.isfinite(x) & np.isfinite(y)
    sides = []
    for values in (x, y):
        places = np.linspace(values[known].min(), values[known].max() + 1e-9, CELLS)
        sides.append(np.stack([np.interp(np.where(known, values, 0.0), places, row) for row in np.eye(CELLS)], axis=1))
    along, across = sides
    return _where(known, (along[:, :, None] * across[:, None, :]).reshape(len(x), -1))


def _waves(values: Array, known: Mask, max_waves: float) -> Iterator[Basis]:
    """Yield sine and cosine of each wavelength that the rows can show."""
    distinct = len(np.unique(values[known]))
    reach = float(np.ptp(values[known]))
    if np.count_nonzero(known) < SCANNED_ROWS or distinct < SCANNED_ROWS / 2 or reach <= 0.0:
        return
    counts, at = np.arange(MIN_WAVES, min(max_waves, distinct / MIN_ROWS_PER_WAVE), 0.5), np.where(known, values, 0.0)
    for count in counts.tolist():
        angle = 2.0 * np.pi * count * at / reach
        columns = _where(known, np.stack([np.cos(angle), np.sin(angle)], axis=1))
        yield Basis(columns, f"wave of {reach / count:.3g}", tries=len(counts))

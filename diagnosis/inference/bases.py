"""Flexible functions of a covariate, as columns: what a residual could look like if nothing were known of its cause."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from diagnosis.measured.channel import Array, Mask
from diagnosis.stages.base import Covariate, Shape

KNOTS = 8
FEW_KNOTS = 4
FEW_ROWS = 30
SINCE_KNOTS = 16
"""At times since an event, each as many times later than the one before."""
HARMONICS = 3
JUMPS = 40
"""Steps at quantiles, among any functions."""
CATEGORIES = 30
"""Beyond these, categories are as good as rows."""
CELLS = 4
"""Along each side of a place's grid."""
LEAST_ROWS = 4
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
    if np.count_nonzero(known) < 2 * LEAST_ROWS:
        return
    if covariate.second is not None:
        yield from _kept(_grid(values, covariate.second[rows]), "place")
    elif covariate.shape is Shape.CATEGORY:
        names = np.unique(values[known])
        if 2 <= len(names) <= CATEGORIES:
            yield from _kept(np.where(known[:, None], values[:, None] == names, 0.0).astype(float), "category")
    elif covariate.shape is Shape.PERIODIC:
        turns = np.arange(1, HARMONICS + 1)
        angle = np.where(known, values, 0.0)[:, None] * turns
        columns = np.concatenate([np.cos(angle), np.sin(angle)], axis=1)
        yield from _kept(_where(known, columns), "turn")
        if covariate.size is not None:
            yield from _kept(_where(known, columns * covariate.size[rows, None]), "turn, times the speed")
    else:
        yield from _kept(_hats(values, known, _quantiles(values[known])), "trend")
        if covariate.shape is Shape.SINCE:
            yield from _kept(_settling(covariate, rows), "settling")
        yield from _waves(values, known)


def any_function(covariate: Covariate, rows: Mask) -> Array:
    """Columns (n, k) that come near any function of a covariate, jumps and waves too, to stand beside a named effect.

    Over all samples, 0 where the covariate is not known and at rows that are not asked for.
    """
    found = [basis.columns for basis in bases(covariate, rows) if basis.tries == 1]
    if covariate.shape in {Shape.SMOOTH, Shape.SINCE} and covariate.second is None:
        values = covariate.values[rows]
        known = np.isfinite(values)
        edges = np.unique(np.quantile(values[known], np.linspace(0.0, 1.0, JUMPS + 1)[1:-1])) if known.any() else []
        found.append(np.where(known[:, None], values[:, None] >= np.array(edges), 0.0).astype(float))
    columns = np.zeros((len(rows), sum(part.shape[1] for part in found)))
    columns[rows] = np.concatenate(found, axis=1) if found else 0.0
    return columns


def _kept(columns: Array, what: str) -> Iterator[Basis]:
    about = np.count_nonzero(np.abs(columns) > 1e-9, axis=0) >= LEAST_ROWS
    if about.any():
        yield Basis(columns[:, about], what)


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

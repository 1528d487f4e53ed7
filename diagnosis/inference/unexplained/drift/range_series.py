"""Residuals of the range sensors in order of time or of a covariate, for the test of a random drift.

Several sensors follow each other in one series. Their coordinates are so far apart that an error with a memory forgets
everything between two sensors: each has a path of its own, with the same standard deviation and time constant. So have
two trials of a sensor, unless a session states the time between them.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.unexplained.adequacy import SESSION
from diagnosis.measured.case_files.case_format import RANGES
from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import ROW_TIME, SESSION_TIME, Covariate, CovariateShape, Observed
from symolo.core.arrays import Array

ROWS_OF_SENSOR = 400
"""Number of rows of a sensor from which neighbours are averaged, since the time grows with its third power."""
PAUSE_STEPS = 10.0
"""Step between two rows, in median steps, across which they are not averaged: a pause, or another sensor."""
APART = 1e3
"""Distance between the coordinates of two sensors or categories, in their whole range."""
WALL = "wall"
"""Of other categories, such as materials, the list has effects."""
_SHARES: Array = np.geomspace(0.05, 1.0, 12)
"""Lengths of a smooth function of a covariate that are tried, as shares of its range."""
ROUNDING = 1e-9
CELLS = (0.03, 0.06, 0.12, 0.25)
"""Sides of the cells in which an error may depend on a place, as shares of the range of its coordinates."""


@dataclass(frozen=True)
class RangeRows:
    """The samples of all range sensors, one sensor after the other."""

    place: NDArray[np.int64]
    """(N,), index of each among all samples."""
    sensor: NDArray[np.int64]
    """(N,), number of its sensor."""
    path: NDArray[np.int64]
    """(N,), number of the path of errors over time: one for each sensor, or for each trial of a sensor."""
    time: str
    """Name of the time."""
    time_s: Array
    """(N,), NaN where it is not known."""
    covariates: tuple[Covariate, ...]
    """What else their errors may depend on, (N,) each."""

    @property
    def sensors(self) -> int:
        return int(self.sensor.max()) + 1

    def of_sensor(self, values: Array) -> Array:
        """Return coordinates (N,) in which those of different sensors are far apart."""
        return values + APART * _reach(values) * self.sensor

    @property
    def path_time_s(self) -> Array:
        """Return times (N,) in which those of different paths are far apart."""
        return self.time_s + APART * _reach(self.time_s) * self.path


@dataclass(frozen=True)
class RangeSeries:
    """Residuals of a fit in order of a coordinate, as means over neighbours if there are many."""

    at: Array
    """(n,), rising coordinate: the time [s], or a covariate."""
    path: NDArray[np.int64]
    """(n,), number of the path of errors."""
    residual_m: Array
    sd_m: Array
    slopes_m: Array
    """(P, n), derivatives of the predictions by the coordinates of the fit."""

    @classmethod
    def from_fit(
        cls, fit: HypothesisFit, ranges: RangeRows, at: Array, rows: Mask, time_s: Array | None = None
    ) -> "RangeSeries":
        """Return the series of some rows (N,) of the ranges along a coordinate (N,).

        Args:
            fit: The fit.
            ranges: The ranges.
            at: (N,), the coordinate.
            rows: (N,), the rows.
            time_s: (N,), times by which rows are neighbours whose mean is taken; the mean then has the coordinate of
                the row in the middle. By default rows are neighbours along the coordinate.
        """
        along = at if time_s is None else time_s
        inside = np.flatnonzero(rows)[np.argsort(along[rows], kind="stable")]
        begins = _begins(along[inside], ROWS_OF_SENSOR * ranges.sensors)
        sd_m = fit.sd[ranges.place]
        weight = sd_m[inside] ** -2.0
        total = np.add.reduceat(weight, begins)
        values = np.stack([at, (fit.z * fit.sd)[ranges.place], *(fit.slopes[:, ranges.place] * sd_m)])[:, inside]
        means = np.add.reduceat(weight * values, begins, axis=1) / total
        path, mean_sd_m = ranges.path[inside][begins], total**-0.5
        if time_s is None:
            return cls(means[0], path, means[1], mean_sd_m, means[2:])
        middle = at[inside[(begins + np.append(begins[1:], len(inside))) // 2]]
        order = np.argsort(middle, kind="stable")
        return cls(middle[order], path[order], means[1, order], mean_sd_m[order], means[2:, order])

    @property
    def z(self) -> Array:
        return self.residual_m / self.sd_m

    def cost_of(self, squares: float) -> float:
        """Return -2 log-likelihood of white noise with some sum of squares in `sd_m`, as `likelihoods` counts it."""
        return len(self.at) * float(np.log(squares / len(self.at))) + 2.0 * float(np.log(self.sd_m).sum())


def _begins(at: Array, max_size: int) -> NDArray[np.int64]:
    """Return the first of each group of neighbours; no group reaches across a gap."""
    steps = np.diff(at)
    gaps = np.flatnonzero(steps > PAUSE_STEPS * np.median(steps)) + 1
    size = -(-len(at) // max_size)
    return np.concatenate([np.arange(a, b, size) for a, b in pairwise([0, *gaps.tolist(), len(at)])])


def range_rows(evidence: Evidence) -> RangeRows | None:
    """Return the samples of the range sensors; None without any or without their times."""
    samples = [(o, p) for o, p in zip(evidence.observed, evidence.places, strict=True) if o.name in RANGES]
    times = [{c.name: c.values for c in o.covariates if c.name in (SESSION_TIME, ROW_TIME)} for o, _ in samples]
    time = next((name for name in (SESSION_TIME, ROW_TIME) if times and all(name in each for each in times)), None)
    if time is None:
        return None
    time_s = np.concatenate([each[time] for each in times])
    sensor = np.concatenate([np.full(place.stop - place.start, number) for number, (_, place) in enumerate(samples)])
    trial = np.concatenate([observed.trial for observed, _ in samples])
    return RangeRows(
        np.concatenate([np.arange(place.start, place.stop) for _, place in samples]),
        sensor,
        sensor if _follow_each_other(trial, time_s) else sensor * (int(trial.max()) + 1) + trial,
        time,
        time_s,
        tuple(_covariates([observed for observed, _ in samples])),
    )


def _follow_each_other(trial: NDArray[np.int64], time_s: Array) -> bool:
    """Return whether each trial begins after the one before has ended, so that one clock counts their times."""
    spans = [time_s[(trial == number) & np.isfinite(time_s)] for number in np.unique(trial).tolist()]
    return all(before.max() < after.min() for before, after in pairwise(span for span in spans if len(span)))


def _covariates(observed: list[Observed]) -> Iterator[Covariate]:
    """Yield the covariates that all sensors have, except for those that tell the time."""
    for first in observed[0].covariates:
        each = [c for o in observed for c in o.covariates if c.name == first.name]
        if first.name not in (*SESSION, ROW_TIME) and len(each) == len(observed):
            second = None if first.second is None else np.concatenate([np.asarray(c.second) for c in each])
            size = None if first.size is None else np.concatenate([np.asarray(c.size) for c in each])
            values = np.concatenate([c.values for c in each])
            yield Covariate(first.name, values, first.shape, second, size=size, corners=first.corners)


def coordinates(covariate: Covariate) -> Iterator[tuple[Array, Array]]:
    """Yield coordinates (N,) along which an error may be smooth, and lengths (T,) over which it may change.

    A category, and a cell of a place, has an error of its own: it is one point, far from the others.
    """
    if covariate.second is not None:
        both = np.stack([covariate.values, covariate.second])
        longest_m = max(_reach(values) for values in both)
        for share in CELLS if longest_m > 0.0 else ():
            column, row = np.floor(both / (share * longest_m))
            yield APART * (column + APART * row), np.ones(1)
    elif covariate.name == WALL:
        yield APART * covariate.values, np.ones(1)
    elif covariate.shape is CovariateShape.PERIODIC:
        # Whole turns would tell the time.
        yield np.mod(covariate.values, 2.0 * np.pi), 2.0 * np.pi * _SHARES
    elif covariate.shape is CovariateShape.OUTLINE:
        # An error may jump at a corner.
        part = np.searchsorted(covariate.corners, covariate.values, side="right")
        yield covariate.values + APART * covariate.corners[-1] * part, float(np.diff(covariate.corners).max()) * _SHARES
    elif covariate.shape is CovariateShape.SMOOTH:
        reach = _reach(covariate.values)
        # The means of equal values may differ in their last digits.
        if reach > ROUNDING * float(np.nanmax(np.abs(covariate.values))):
            yield covariate.values, reach * _SHARES


def _reach(values: Array) -> float:
    known = values[np.isfinite(values)]
    return float(np.ptp(known)) if len(known) else 0.0


def each_path(series: RangeSeries) -> Iterator[Mask]:
    """Yield the rows (n,) of each path of errors."""
    for number in np.unique(series.path):
        yield series.path == number

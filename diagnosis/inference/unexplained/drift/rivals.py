"""What looks like a random drift of range sensors: errors that are simpler, or that depend on something else."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.unexplained.drift.gauss_markov import Likelihoods, likelihoods
from diagnosis.inference.unexplained.drift.range_series import RangeRows, RangeSeries, coordinates, each_path
from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array

SHORT = (0.3, 0.45, 0.62)
"""Time constants of correlated noise, in rows of a bench: neighbours have a correlation of up to 0.2."""
SHORT_OF_SERIES = (0.3, 0.6, 1.0, 1.5, 2.0, 3.0)
"""The same in rows of a time series."""
RATIOS = np.geomspace(0.01, 1000.0, 50)
"""Variance of the random drift over that of the white noise."""
WITHOUT_WHITE = np.array([1e3])
"""Such a ratio for noise that has hardly any white part."""
DISTANCE = "distance_m"
MIN_WAVES = 1.5
"""Smallest number of waves within the range of the distance."""
MIN_ROWS_OF_WAVE = 3.0
"""Smallest number of rows in a wave."""
STEP_OF_WAVES = 1.0 / 8.0
"""Step of the number of waves. A wave between two steps keeps 99 % of its power: sinc(1/16) squared."""
MIN_WAVES_OF_TIME = 2.0
"""The same within the time; an error that does not repeat cannot be distinguished from a drift."""


def gains_of_others(
    fit: HypothesisFit, times_s: Array, ranges: RangeRows, time_s: Array, rows: Mask, *, is_bench: bool
) -> Iterator[float]:
    """Yield the falls of the cost of white noise by errors that look alike where a log is not varied enough.

    One of them drifts in proportion to the distance, as a scale does. The others are any functions of a covariate other
    than time, of each sensor or of all of them: along it, they have the same likelihood as a random drift has along
    time. Their white noise may have any size, as that to which each is compared has, while that beside the drift is at
    most twice the stated one. So a rival is never less likely than with the same limit: what a large noise explains as
    well is not named a drift.

    In a time series, the poses that successive rows share correlate their noise. Any function of what changes slowly
    follows it, but not means over neighbours in time, in which it is noise. So each rival explains the same means as
    the drift.
    """
    for covariate in ranges.covariates:
        known = rows & np.isfinite(covariate.values)
        if not known.any():
            continue
        by_size = fit if covariate.size is None else _in_units_of(fit, ranges, np.where(known, covariate.size, 1.0))
        for at, lengths in coordinates(covariate):
            for along in (ranges.of_sensor(at), at) if ranges.sensors > 1 else (at,):
                series = RangeSeries.from_fit(by_size, ranges, along, known, None if is_bench else time_s)
                yield _gain(series, likelihoods(series.at, series.residual_m, series.sd_m, lengths, RATIOS))
        if covariate.name == DISTANCE:
            share = np.where(known, covariate.values, 1.0)
            series = RangeSeries.from_fit(_in_units_of(fit, ranges, share), ranges, time_s, known & (share > 0.0))
            likely = likelihoods(series.at, series.residual_m, series.sd_m, times_s, RATIOS)
            yield _gain(series, likely)


def costs_of_waves(fit: HypothesisFit, ranges: RangeRows, rows: Mask) -> Iterator[float]:
    """Yield the cost of white noise about the best wave along the distance, and about the best one over time.

    The first is a cyclic error of the phase; the second is one that repeats, such as the beat of two clocks or a lamp
    that turns on and off. A random drift follows one of many waves by chance, so each period that is tried over time
    has the same share of the probability.
    """
    for covariate in ranges.covariates:
        if covariate.name == DISTANCE:
            yield _cost_of_wave(fit, ranges, covariate.values, rows, MIN_WAVES)
    yield _cost_of_wave(fit, ranges, ranges.time_s, rows, MIN_WAVES_OF_TIME, of_each_period=True)


def _cost_of_wave(
    fit: HypothesisFit,
    ranges: RangeRows,
    along: Array,
    rows: Mask,
    min_waves: float,
    *,
    of_each_period: bool = False,
) -> float:
    """Return the cost of white noise about the best wave along values (N,) with at least so many periods.

    Args:
        fit: The fit whose residuals are tested.
        ranges: The samples.
        along: (N,), the values.
        rows: (N,), the samples that count.
        min_waves: Smallest number of waves.
        of_each_period: Whether all whole numbers of waves share the probability.
    """
    known = rows & np.isfinite(along)
    if not known.any():
        return np.inf
    series = RangeSeries.from_fit(fit, ranges, along, known)
    turns = 2.0 * np.pi * (series.at - series.at[0]) / max(float(np.ptp(series.at)), 1e-12)
    best, max_waves = np.inf, len(np.unique(series.at)) / MIN_ROWS_OF_WAVE
    for waves in np.arange(min_waves, max_waves, STEP_OF_WAVES):
        both = np.stack([np.cos(waves * turns), np.sin(waves * turns)], axis=1) / series.sd_m[:, None]
        best = min(best, series.cost_of(left_over(series.z, both)))
    return best + (2.0 * float(np.log(max(1.0, max_waves - min_waves))) if of_each_period else 0.0)


def _in_units_of(fit: HypothesisFit, ranges: RangeRows, unit: Array) -> HypothesisFit:
    """Return a fit whose ranges are in units (n,) of their own, in which an error has the same size in all rows."""
    sd = fit.sd.copy()
    sd[ranges.place] /= unit
    return replace(fit, sd=sd)


def _gain(series: RangeSeries, likely: Likelihoods) -> float:
    """Return the fall of the cost of white noise by an error beside it."""
    return series.cost_of(float(series.z @ series.z)) - float(likely.costs.min())


def short_noise(series: RangeSeries, times_s: Array, max_level: float) -> tuple[float, float]:
    """Return cost and variance of noise that is correlated over few rows and has hardly any white part.

    It is no larger than noise can be; a larger error is a drift.

    Args:
        series: The residuals.
        times_s: (T,), time constants.
        max_level: Largest variance of the noise, relative to that of the rows.
    """
    max_share = max_level / float(WITHOUT_WHITE[0])
    likely = likelihoods(series.at, series.residual_m, series.sd_m, times_s, WITHOUT_WHITE, max_level=max_share)
    best = np.unravel_index(int(likely.costs.argmin()), likely.costs.shape)
    return float(likely.costs[best]), float(likely.levels[best] * (1.0 + WITHOUT_WHITE[0]))


def lines(series: RangeSeries) -> Array:
    """Return a constant and a line in time (n, 2 K) for each of the K paths."""
    columns = [inside * (series.at - series.at[inside].mean()) ** k for inside in each_path(series) for k in (0, 1)]
    return np.stack(columns, axis=1)


def left_over(z: Array, columns: Array) -> float:
    """Return the sum of squares that the columns leave."""
    rest = z - columns @ np.linalg.lstsq(columns, z, rcond=None)[0]
    return float(rest @ rest)

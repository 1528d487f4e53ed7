"""Fits with a random drift of range sensors beside them, of every size and time constant.

The rows of a bench are separate readings, whose noise is white or nearly so. In a time series, the ranges are predicted
from poses that successive rows share. So an error that lasts for few rows is a drift on a bench only.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.inference.evidence.drift_memory import DriftMemory
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.likelihood import LEVEL_SD, LEVELS
from diagnosis.inference.selection.penalty import PARAMETER_PENALTY, parameter_penalty
from diagnosis.inference.selection.refusal import PER_PARAMETER, THRESHOLD, THRESHOLD_OF_NOISE
from diagnosis.inference.unexplained.change import MOMENT_PARAMETERS
from diagnosis.inference.unexplained.drift.elsewhere import Elsewhere
from diagnosis.inference.unexplained.drift.gauss_markov import (
    ErrorModel,
    Likelihoods,
    LinearEstimate,
    estimate,
    likelihoods,
    predictable,
)
from diagnosis.inference.unexplained.drift.jump import best_jump
from diagnosis.inference.unexplained.drift.range_series import RangeRows, RangeSeries, range_rows
from diagnosis.inference.unexplained.drift.rivals import (
    RATIOS,
    SHORT,
    SHORT_OF_SERIES,
    costs_of_waves,
    gains_of_others,
    left_over,
    lines,
    short_noise,
)
from diagnosis.inference.unexplained.drift.sawtooth import squares_of_sawtooth
from diagnosis.inference.unexplained.drift.switching import squares_of_switching
from diagnosis.measured.channel import Mask
from sensors.effects.range_sensor.range_wander import RangeWander
from symolo.core.arrays import Array

OUTLIER = 4.0
"""Distance from the median, in standard deviations, from which a row is left out."""
MEDIAN_OF_NORMAL = 0.6745
"""Median distance of normal noise from its mean, in standard deviations."""
MIN_ROWS = 20
MIN_ROWS_OF_SERIES = 30
MIN_LASTING_ROWS = 1.5
"""Smallest time constant in rows of a bench; noise that is correlated over fewer rows is no drift."""
MIN_LASTING_ROWS_OF_SERIES = 5.0
TIMES = 12
"""Number of time constants that are tried, from the smallest one to the length of the measurement."""
TIME_CONSTANT_LIMITS = RangeWander.parameters()["time_constant_s"]
"""Smallest and largest time constant of the effect, which hold for rows of any distance."""


@dataclass(frozen=True)
class DriftFit:
    """A fit with a random drift beside it."""

    fit: HypothesisFit
    series: RangeSeries
    times_s: Array
    """(T,), time constants that were tried."""
    max_level: float
    """Largest variance that the noise can have without an effect of its own, relative to that of the fit."""
    likelihoods: Likelihoods
    elsewhere: Elsewhere

    @property
    def cost(self) -> float:
        return float(self.likelihoods.costs.min())

    @property
    def shares(self) -> Array:
        """Return the probability (T, R) of each time constant and ratio."""
        likelihood = np.exp(-0.5 * (self.likelihoods.costs - self.cost))
        return likelihood / likelihood.sum()

    @property
    def error(self) -> ErrorModel:
        """Return the most probable error."""
        tau, ratio = np.unravel_index(int(self.likelihoods.costs.argmin()), self.likelihoods.costs.shape)
        level = float(self.likelihoods.levels[tau, ratio])
        unit_m = float(np.median(self.series.sd_m))
        return ErrorModel(float(self.times_s[tau]), unit_m * float(np.sqrt(level * RATIOS[ratio])), level)

    def estimate(self, series: RangeSeries) -> LinearEstimate:
        """Return the change of the coordinates beside the error, from some series of the fit and its other samples."""
        covariance = self.error.covariance(series.at, series.sd_m)
        elsewhere = self.elsewhere
        return estimate(series.residual_m, series.slopes_m, covariance, elsewhere.information, elsewhere.pull)

    def joint_cost(self, elsewhere: Elsewhere) -> float:
        """Return -2 log-likelihood at the most probable change, up to a constant."""
        covariance = self.error.covariance(self.series.at, self.series.sd_m)
        result = replace(self, elsewhere=elsewhere).estimate(self.series)
        squares = result.squares + elsewhere.squares_after(result.change)
        return float(np.linalg.slogdet(covariance)[1]) + squares

    def path(self, series: RangeSeries, time_s: Array) -> Array:
        """Return the most probable error (n,) at each time; that of the first row where a time is not known.

        It is the mean of a Gaussian process, given residuals (Rasmussen and Williams, Gaussian Processes for Machine
        Learning, 2006, eq. 2.23).
        """
        at_s = np.where(np.isfinite(time_s), time_s, series.at[0])
        residual_m = series.residual_m - self.estimate(series).change @ series.slopes_m
        covariance = self.error.covariance(series.at, series.sd_m)
        return self.error.between(at_s, series.at) @ np.linalg.solve(covariance, residual_m)


@dataclass(frozen=True)
class DriftSearch:
    """The rows in which a random drift is looked for, and how long it may last."""

    evidence: Evidence
    ranges: RangeRows
    time_s: Array
    """(n,), time of each sample of the ranges; those of different paths are far apart."""
    rows: Mask
    """(n,), samples of the fit that are no outliers."""
    times_s: Array
    """(T,), time constants that are tried."""
    row_s: float
    """Time from one row to the next."""

    @classmethod
    def from_fit(cls, evidence: Evidence, fit: HypothesisFit) -> "DriftSearch | None":
        """Return the search in the rows that are no outliers of a fit; None if they cannot show a drift."""
        ranges = range_rows(evidence)
        if ranges is None:
            return None
        series = _is_series(evidence)
        time_s = ranges.path_time_s
        rows = regular(fit.z[ranges.place], evidence.fit[ranges.place] & np.isfinite(time_s))
        if np.count_nonzero(rows) < (MIN_ROWS_OF_SERIES if series else MIN_ROWS):
            return None
        at_s = RangeSeries.from_fit(fit, ranges, time_s, rows).at
        row_s, span_s = float(np.median(np.diff(at_s))), float(np.ptp(ranges.time_s[rows]))
        lasting_s = (MIN_LASTING_ROWS_OF_SERIES if series else MIN_LASTING_ROWS) * row_s
        shortest_s, longest_s = max(lasting_s, TIME_CONSTANT_LIMITS.low), min(span_s, TIME_CONSTANT_LIMITS.high)
        if not (0.0 < 2.0 * lasting_s < span_s and shortest_s < longest_s):
            return None
        return cls(evidence, ranges, time_s, rows, np.geomspace(shortest_s, longest_s, TIMES), row_s)

    @property
    def is_bench(self) -> bool:
        """Return whether the rows are separate readings."""
        return not _is_series(self.evidence)

    @property
    def needed(self) -> float:
        """Return the fall of the cost of white noise from which a drift is accepted.

        On a bench it is one of three effects of the noise. In 200 benches with nothing hidden (seed 9504 of
        `benchmarks/diagnosis/independent_cases`), the largest fall was 9.5.
        """
        return (THRESHOLD_OF_NOISE if self.is_bench else THRESHOLD) + PER_PARAMETER

    def series(self, fit: HypothesisFit) -> RangeSeries:
        """Return the residuals of a fit."""
        return RangeSeries.from_fit(fit, self.ranges, self.time_s, self.rows)

    def cost_of_white_noise(self, fit: HypothesisFit, *, as_stated: bool = False) -> float:
        """Return -2 log-likelihood of the residuals of a fit as white noise, of any size or at most as stated."""
        series = self.series(fit)
        squares, count = float(series.z @ series.z), len(series.at)
        level = squares / count
        if as_stated:
            level = min(level, self._levels(fit)[1])
        return series.cost_of(level * count) + squares / level - count

    def _levels(self, fit: HypothesisFit) -> tuple[float, float]:
        """Return the smallest and the largest variance of the noise, relative to that of a fit."""
        by_fit = float(fit.noise.levels[np.unique(self.evidence.quantity[self.ranges.place])].min())
        return (1.0 / LEVELS[1] / by_fit) ** 2, (LEVELS[1] / by_fit) ** 2

    def with_drifted_rows(self, seen: DriftFit) -> "DriftSearch":
        """Return the search with those rows of a series, too, that are no outliers of a drift which other rows show.

        Where the noise of the readings is small, as near a wall, a drift takes them many standard deviations away.
        """
        if self.is_bench:
            return self
        place, fit = self.ranges.place, seen.fit
        candidates = np.flatnonzero(self.evidence.fit[place] & np.isfinite(self.time_s))
        inside = candidates[np.argsort(self.time_s[candidates], kind="stable")]
        residual_m, sd_m = (fit.z * fit.sd)[place][inside], fit.sd[place][inside]
        rows = self.rows.copy()
        rows[inside] |= predictable(self.time_s[inside], residual_m, sd_m, seen.error, OUTLIER)
        return replace(self, rows=rows)

    def without_outliers(self, seen: DriftFit) -> "DriftSearch":
        """Return the search in the rows of a bench that are no outliers beside a drift, which other rows show.

        The residual of a row, given all others, follows from the inverse covariance (Rasmussen and Williams 2006,
        eq. 5.12).
        """
        series = seen.series
        if not self.is_bench or len(series.at) < np.count_nonzero(self.rows):
            return self
        inverse = np.linalg.inv(seen.error.covariance(series.at, series.sd_m))
        residual_m = series.residual_m - seen.estimate(series).change @ series.slopes_m
        z = inverse @ residual_m / np.sqrt(np.diag(inverse))
        return self._with_rows(np.abs(z) <= OUTLIER)

    def beside(self, fit: HypothesisFit) -> DriftFit:
        """Return a fit with a random drift beside it."""
        series, (min_level, max_level) = self.series(fit), self._levels(fit)
        tried = series.at, series.residual_m, series.sd_m, self.times_s, RATIOS
        if self.is_bench:
            # An error that lasts for few rows must not stand for the noise.
            best = likelihoods(*tried, min_level=min_level, max_level=max_level)
            # The noise may have an effect of its own.
            free = likelihoods(*tried, min_level=min_level)
            best = free if best.costs.min() - free.costs.min() >= THRESHOLD_OF_NOISE else best
        else:
            best = likelihoods(*tried, max_level=max_level)
        return DriftFit(fit, series, self.times_s, max_level, best, self.elsewhere(fit, fit))

    def elsewhere(self, fit: HypothesisFit, beside: HypothesisFit) -> Elsewhere:
        """Return what a fit says about tolerances and other quantities, by samples that are no outliers of another."""
        rows = self.evidence.fit & (np.abs(beside.z) < OUTLIER)
        rows[self.ranges.place] = False
        weight, unit = self.evidence.weight[rows], fit.sd[rows] / beside.sd[rows]
        z, slopes = fit.z[rows] * unit, fit.slopes[:, rows] * unit
        prior = (np.arange(len(fit.x)) < len(fit.hypothesis.nuisances)).astype(float)
        return Elsewhere(
            (slopes * weight) @ slopes.T + np.diag(prior),
            slopes @ (weight * z) - prior * fit.x,
            float(weight @ z**2 + prior @ fit.x**2),
        )

    def cost_of_line(self, seen: DriftFit) -> float:
        """Return the cost of white noise about a line in time."""
        z, sd = seen.series.z, seen.series.sd_m
        return seen.series.cost_of(left_over(z, lines(seen.series) / sd[:, None]))

    def costs_of_rivals(self, seen: DriftFit, nominal: HypothesisFit) -> Iterator[float]:
        """Yield the costs of what looks like a drift and has no name, penalised so that all can be compared with it."""
        yield self.cost_of_line(seen)
        # A jump has a size and a moment, which counts as two numbers, and a drift has two.
        jump_penalty = PARAMETER_PENALTY * (MOMENT_PARAMETERS if self.is_bench else 1)
        yield seen.cost + self._rise_with_jump(seen, seen.fit) + jump_penalty
        short_s = np.array(SHORT if self.is_bench else SHORT_OF_SERIES) * self.row_s
        short, level = short_noise(seen.series, short_s, seen.max_level)
        yield short + self._prior_of_level(seen, level) - self._prior_of_level(seen, seen.error.level)
        yield seen.cost + self._rise_with_jump(seen, nominal) + jump_penalty - parameter_penalty(seen.fit)
        if self.is_bench:
            # Size, phase and length.
            for cost in costs_of_waves(seen.fit, self.ranges, self.rows):
                yield cost + 2.0 * PARAMETER_PENALTY
            # Two moments in a period count as those of a jump; a sawtooth has one.
            yield self._cost_of_repeating(seen, *squares_of_switching(seen.series), 2)
            yield self._cost_of_repeating(seen, *squares_of_sawtooth(seen.series), 1)
        # These have as many numbers as the drift, so that they only need to be less likely.
        white = self.cost_of_white_noise(seen.fit)
        tried = seen.fit, self.times_s, self.ranges, self.time_s, self.rows
        for gain in gains_of_others(*tried, is_bench=self.is_bench):
            yield white - gain + PARAMETER_PENALTY

    def _cost_of_repeating(self, seen: DriftFit, squares: float, periods: float, moments: int) -> float:
        """Return the penalised cost of white noise about an offset that repeats, which leaves squares.

        All whole numbers of periods share the probability.
        """
        numbers = moments * MOMENT_PARAMETERS
        return seen.series.cost_of(squares) + PARAMETER_PENALTY * numbers + 2.0 * float(np.log(periods))

    def _rise_with_jump(self, seen: DriftFit, fit: HypothesisFit) -> float:
        """Return the rise of the cost by a jump beside a fit in the place of a random drift beside its own fit.

        Beside a jump, offset and scale differ from those of the fit, which have taken over a part of it. Rows that are
        outliers beside the jump count for neither; beside the fit, they may look like others.
        """
        jump = best_jump(self.series(fit), self.elsewhere(fit, seen.fit))
        if jump is None:
            return np.inf
        if len(jump.z) < np.count_nonzero(self.rows):  # means over neighbours
            return jump.cost - seen.joint_cost(seen.elsewhere)
        search = self._with_rows(regular(jump.z, np.ones(len(jump.z), dtype=bool)))
        beside, left = search.beside(seen.fit), best_jump(search.series(fit), search.elsewhere(fit, seen.fit))
        return np.inf if left is None else left.cost - beside.joint_cost(beside.elsewhere)

    def _with_rows(self, usable: Mask) -> "DriftSearch":
        """Return the search in some of its rows (n,), which are in order of time."""
        rows = self.rows.copy()
        rows[np.flatnonzero(rows)[np.argsort(self.time_s[rows], kind="stable")]] = usable
        return replace(self, rows=rows)

    def _prior_of_level(self, seen: DriftFit, level: float) -> float:
        """Return the prior cost of a variance of the noise, relative to that of a fit; one on a bench only."""
        if not self.is_bench:
            return 0.0
        by_fit = seen.fit.noise.levels[self.evidence.quantity[self.ranges.place[0]]]
        return float((np.log(np.clip(by_fit * np.sqrt(level), 1.0 / LEVELS[1], LEVELS[1])) / LEVEL_SD) ** 2)

    def memory(self, seen: DriftFit) -> DriftMemory | None:
        """Return what the drift carries over to the rows of a bench; None for a series, or means over neighbours.

        A row knows the rows before it. A held-out one knows all rows of the fit, and none of the held-out ones.
        """
        evidence, series, place = self.evidence, seen.series, self.ranges.place
        inside = np.flatnonzero(self.rows)[np.argsort(self.time_s[self.rows], kind="stable")]
        if not self.is_bench or len(inside) > len(series.at):
            return None
        error, at_s = seen.error, series.at
        white_m2 = error.level * seen.fit.sd[place] ** 2
        lower = np.linalg.cholesky(error.covariance(at_s, series.sd_m))
        scale = np.diag(lower)
        shares, open_m2 = np.zeros((len(place), len(place))), np.zeros(len(place))
        shares[np.ix_(inside, inside)] = np.eye(len(inside)) - scale[:, None] * np.linalg.inv(lower)
        open_m2[inside] = scale**2 - white_m2[inside]
        for row in np.flatnonzero(~self.rows & np.isfinite(self.time_s)).tolist():
            known = at_s < self.time_s[row] if evidence.fit[place[row]] else np.ones(len(at_s), dtype=bool)
            near = error.between(self.time_s[row : row + 1], at_s[known])[0]
            share = np.linalg.solve(error.covariance(at_s[known], series.sd_m[known]), near)
            shares[row, inside[known]] = share
            open_m2[row] = error.error_m**2 - share @ near
        count = len(evidence.values)
        every, wider, reference = np.zeros((count, count)), np.ones(count), np.zeros(count)
        every[np.ix_(place, place)] = shares
        wider[place] = np.sqrt(1.0 + np.maximum(open_m2, 0.0) / white_m2)
        change = seen.estimate(series).change @ (seen.fit.slopes * seen.fit.sd)
        reference[place] = np.nan_to_num(evidence.values - seen.fit.z * seen.fit.sd + change)[place]
        return DriftMemory(every, wider, reference)


def regular(z: Array, rows: Mask) -> Mask:
    """Return which of some rows (N,) are no outliers, by their residuals (N,) in sigmas.

    A random drift may take all readings many sigmas away from their prediction. So the scale is that of the residuals
    themselves, by their median absolute deviation, if that is larger than the noise.
    """
    if not rows.any():
        return rows
    deviation = np.abs(z - np.median(z[rows]))
    return rows & (deviation < OUTLIER * max(1.0, float(np.median(deviation[rows])) / MEDIAN_OF_NORMAL))


def _is_series(evidence: Evidence) -> bool:
    return any(observed.is_series for observed in evidence.observed)

"""Test whether range sensors have a random drift, and how large that is.

The drift (effect `range_wander`) has a standard deviation and a time constant, and no law. Its name stands only if its
likelihood beats that of all that looks like it: white noise, a drift after power-on, a linear drift, a jump at one
moment, noise that is correlated over few rows, a scale that drifts randomly, and any smooth function of another
covariate. The likelihood is that of a first-order Gauss-Markov error beside white noise, with the error itself
integrated out (`diagnosis.inference.unexplained.gauss_markov`).

It imitates a drift after power-on, an offset, and structure along anything that changes slowly. So the selected effects
are weighed again beside it: what it explains by itself is no effect.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from configs.effects.base import Slot
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.fitting.likelihood import LEVELS
from diagnosis.inference.selection.penalty import PARAMETER_PENALTY, parameter_penalty
from diagnosis.inference.selection.refusal import PER_PARAMETER, THRESHOLD, is_of_noise, needed
from diagnosis.inference.selection.removal import without
from diagnosis.inference.selection.rivals import confidence
from diagnosis.inference.unexplained.gauss_markov import ErrorModel, Likelihoods, LinearEstimate, estimate, likelihoods
from diagnosis.inference.unexplained.range_series import RangeRows, RangeSeries, coordinates, range_rows
from diagnosis.measured.channel import Mask
from sensors.effects.range_sensor.range_wander import RangeWander
from sensors.effects.range_sensor.warmup_drift import WarmupDrift
from symolo.core.arrays import Array

OUTLIER = 4.0
"""Distance from the median, in standard deviations, from which a row is left out."""
MEDIAN_OF_NORMAL = 0.6745
"""Median distance of normal noise from its mean, in standard deviations."""
MIN_ROWS = 30
MIN_LASTING_ROWS = 5.0
"""Least time constant in rows; noise that is correlated over fewer rows is no drift."""
SHORT = (0.3, 0.6, 1.0, 1.5, 2.0, 3.0)
"""Time constants of correlated noise, in rows."""
JUMP_ROWS = 4
"""Rows at either end between which an offset may jump."""
RATIOS = np.geomspace(0.01, 1000.0, 50)
"""Variance of the random drift over that of the white noise."""
WITHOUT_WHITE = np.array([1e3])
"""Such a ratio for noise that has hardly any white part."""
TIMES = 12
"""Number of time constants that are tried, from the least one to the length of the measurement."""
DISTANCE = "distance_m"
SURE = 0.95
"""Probability of the shortest time constant, a few fitted rows, from which the error counts as correlated noise."""
EQUAL = 1e-6
"""Difference of the cost that is only rounding error."""
TIME_CONSTANT_LIMITS = RangeWander.parameters()["time_constant_s"]
"""Least and greatest time constant of the effect, which hold for rows of any distance."""


@dataclass(frozen=True)
class RandomDrift:
    """A random drift of a range sensor."""

    effect: RangeWander
    std: dict[str, float]
    confidence: float
    path_m: Array
    """(N,), the most probable error at each sample, given the fitted rows; 0 outside the quantity. Held-out rows
    have no part in it, so that they can judge the effects; the error that it cannot predict stays in them."""
    seen_for: dict[str, list[float]]
    """First and last time [s] at which it was seen, by the name of the time."""

    def answer(self) -> dict[str, object]:
        """Return the error in GAP_FORMAT, ready for JSON."""
        return {
            "name": self.effect.name,
            "parameters": self.effect.model_dump(),
            "std": self.std,
            "confidence": round(self.confidence, 4),
            "ambiguous_with": [],
            "range": self.seen_for,
        }


@dataclass(frozen=True)
class _Elsewhere:
    """What tolerances, and samples of other quantities, say about a change of the coordinates of a fit."""

    information: Array
    """(P, P)"""
    pull: Array
    """(P,), product of the information with the change that is most probable."""
    squares: float
    """Their sum of squares without a change."""

    def squares_after(self, change: Array) -> float:
        return float(self.squares - 2.0 * change @ self.pull + change @ self.information @ change)


@dataclass(frozen=True)
class _Seen:
    """A fit with a random drift beside it."""

    fit: HypothesisFit
    series: RangeSeries
    times_s: Array
    """(T,), time constants that were tried."""
    greatest_level: float
    """Greatest variance that the noise can have, relative to that of the fit."""
    found: Likelihoods
    elsewhere: _Elsewhere

    @property
    def cost(self) -> float:
        return float(self.found.costs.min())

    @property
    def shares(self) -> Array:
        """Return the probability (T, R) of each time constant and ratio."""
        likelihood = np.exp(-0.5 * (self.found.costs - self.cost))
        return likelihood / likelihood.sum()

    @property
    def error(self) -> ErrorModel:
        """Return the most probable error."""
        tau, ratio = np.unravel_index(int(self.found.costs.argmin()), self.found.costs.shape)
        level = float(self.found.levels[tau, ratio])
        unit_m = float(np.median(self.series.sd_m))
        return ErrorModel(float(self.times_s[tau]), unit_m * float(np.sqrt(level * RATIOS[ratio])), level)

    def estimate(self, series: RangeSeries) -> LinearEstimate:
        """Return the change of the coordinates beside the error, from some series of the fit and its other samples."""
        covariance = self.error.covariance(series.at, series.sd_m)
        elsewhere = self.elsewhere
        return estimate(series.residual_m, series.slopes_m, covariance, elsewhere.information, elsewhere.pull)

    def joint_cost(self, elsewhere: _Elsewhere) -> float:
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


def random_drift(evidence: Evidence, nominal: HypothesisFit, fit: HypothesisFit) -> RandomDrift | None:
    """Return the random drift that a reading shows over time; None if anything else explains it.

    Args:
        evidence: The observations.
        nominal: The fit without effects.
        fit: The fit with the selected effects.
    """
    ranges = range_rows(evidence)
    if ranges is None:
        return None
    time_s = ranges.path_time_s
    rows = _regular(fit.z[ranges.place], evidence.fit[ranges.place] & np.isfinite(time_s))
    if np.count_nonzero(rows) < MIN_ROWS:
        return None
    plain = RangeSeries.of(fit, ranges, time_s, rows)
    row_s, span_s = float(np.median(np.diff(plain.at))), float(np.ptp(ranges.time_s[rows]))
    shortest_s = max(MIN_LASTING_ROWS * row_s, TIME_CONSTANT_LIMITS.low)
    longest_s = min(span_s, TIME_CONSTANT_LIMITS.high)
    if not (0.0 < 2.0 * MIN_LASTING_ROWS * row_s < span_s and shortest_s < longest_s):
        return None
    times_s, quantities = np.geomspace(shortest_s, longest_s, TIMES), np.unique(evidence.quantity[ranges.place])

    def beside(other: HypothesisFit) -> _Seen:
        series = RangeSeries.of(other, ranges, time_s, rows)
        most = float((LEVELS[1] / other.noise.levels[quantities].min()) ** 2)
        likely = likelihoods(series.at, series.residual_m, series.sd_m, times_s, RATIOS, greatest_level=most)
        return _Seen(other, series, times_s, most, likely, _elsewhere(evidence, other, ranges, other))

    seen = beside(fit)
    white = plain.cost_of(float(plain.z @ plain.z))
    if white - seen.cost < THRESHOLD + PER_PARAMETER and not _warms_up(fit):
        return None
    # A drift after power-on and a random drift imitate each other.
    others = [white] if _warms_up(fit) else []
    seen = _weighed(evidence, ranges, seen, beside)
    if seen.shares.sum(axis=1)[0] > SURE:  # the noise may be correlated over still fewer rows
        return None
    z, sd = seen.series.z, seen.series.sd_m
    drift = seen.series.cost_of(_left(z, _lines(seen.series) / sd[:, None]))
    others += [drift, _jump(seen.series) + PARAMETER_PENALTY, min(_short(seen, row_s))]
    bare = RangeSeries.of(nominal, ranges, time_s, rows)
    others.append(_jump(bare) + PARAMETER_PENALTY - parameter_penalty(seen.fit))
    white = seen.series.cost_of(float(z @ z))
    # These have as many numbers as the error, so that they only need to be less likely.
    others += [white - gain + PARAMETER_PENALTY for gain in _gains_of_others(seen, ranges, time_s, rows)]
    # At one distance an error of the scale is equally likely, and rounding would decide about the name.
    if min(white, drift) - seen.cost < THRESHOLD + PER_PARAMETER or min(others) - seen.cost < PARAMETER_PENALTY - EQUAL:
        return None
    path_m = np.zeros(len(evidence.values))
    path_m[ranges.place] = seen.path(seen.series, time_s)
    known_s = ranges.time_s[rows]
    return _named(seen, others, white, path_m, {ranges.time: [float(known_s.min()), float(known_s.max())]})


def _regular(z: Array, rows: Mask) -> Mask:
    """Return which of some rows (N,) are no outliers, by their residuals (N,) in sigmas.

    A random drift may take all readings many sigmas away from their prediction. So the scale is that of the residuals
    themselves, by their median absolute deviation, if that is larger than the noise.
    """
    if not rows.any():
        return rows
    deviation = np.abs(z - np.median(z[rows]))
    return rows & (deviation < OUTLIER * max(1.0, float(np.median(deviation[rows])) / MEDIAN_OF_NORMAL))


def _elsewhere(evidence: Evidence, fit: HypothesisFit, ranges: RangeRows, beside: HypothesisFit) -> _Elsewhere:
    """Return what a fit says about tolerances and other quantities, by samples that are no outliers `beside` a fit."""
    rows = evidence.fit & (np.abs(beside.z) < OUTLIER)
    rows[ranges.place] = False
    weight, unit = evidence.weight[rows], fit.sd[rows] / beside.sd[rows]
    z, slopes = fit.z[rows] * unit, fit.slopes[:, rows] * unit
    prior = (np.arange(len(fit.x)) < len(fit.hypothesis.nuisances)).astype(float)
    return _Elsewhere(
        (slopes * weight) @ slopes.T + np.diag(prior),
        slopes @ (weight * z) - prior * fit.x,
        float(weight @ z**2 + prior @ fit.x**2),
    )


def _weighed(evidence: Evidence, ranges: RangeRows, seen: _Seen, beside: Callable[[HypothesisFit], _Seen]) -> _Seen:
    """Return the fit with those effects that the readings need beside a random drift."""
    falls = _falls(seen)
    weak = {effect: fall - needed(effect) for effect, fall in falls.items() if fall < needed(effect)}
    for effect in sorted(weak, key=lambda effect: weak[effect]):
        fit = without(evidence, seen.fit, effect)
        fewer = beside(fit if effect.kind.slot is Slot.RANGE_NOISE else _with_noise_of(seen.fit, fit))
        # The standard errors of an effect that is not linear may be far too large, so that the costs decide. Both count
        # the samples of other quantities that are no outliers with the effect.
        cost_without = fewer.joint_cost(_elsewhere(evidence, fewer.fit, ranges, seen.fit))
        cost_with = seen.joint_cost(_elsewhere(evidence, seen.fit, ranges, seen.fit))
        if cost_without - cost_with < needed(effect):
            return _weighed(evidence, ranges, fewer, beside)
    return seen


def _with_noise_of(other: HypothesisFit, fit: HypothesisFit) -> HypothesisFit:
    """Return a fit whose residuals are in sigmas of another one.

    Without an effect of one sensor, a fit takes its drift for white noise and gives it the more noise, which would then
    count against a drift of all sensors.
    """
    unit = fit.sd / other.sd
    return replace(fit, z=fit.z * unit, sd=other.sd, slopes=fit.slopes * unit, noise=other.noise)


def _falls(seen: _Seen) -> dict[CandidateEffect, float]:
    """Return by how much each effect lowers the cost beside the error (Wald, Trans. AMS 54 (1943) 426).

    It is 0 for an effect of the noise of the ranges. A limit is left out, since no random drift imitates it.
    """
    fit = seen.fit
    result = seen.estimate(seen.series)
    x, variance = fit.x + result.change, np.diag(result.covariance)
    falls = {}
    for effect in fit.hypothesis.effects:
        places = range(len(fit.x))[fit.hypothesis.parameters(effect)]
        sizes = [
            (x[place] - c.null) ** 2 / max(variance[place], 1e-12)
            for place, c in zip(places, effect.coordinates, strict=True)
            if c.null is not None and not c.is_ceiling
        ]
        if effect.kind.slot is Slot.RANGE_NOISE:
            falls[effect] = 0.0
        elif sizes and not is_of_noise(fit, effect):
            falls[effect] = float(max(sizes))
    return falls


def _named(
    seen: _Seen, others: Sequence[float], white: float, path_m: Array, seen_for: dict[str, list[float]]
) -> RandomDrift:
    """Return the error with the mean of its size and time constant over all that were tried."""
    weight = seen.shares
    middle_m = float(np.median(seen.series.sd_m))
    (sd_of, sd_error), (tau, tau_error) = (
        _mean_and_error(values, weight)
        for values in (
            middle_m * np.sqrt(seen.found.levels * RATIOS),
            np.broadcast_to(seen.times_s[:, None], weight.shape),
        )
    )
    return RandomDrift(
        RangeWander(sd_m=min(sd_of, 0.1), time_constant_s=tau),
        {"sd_m": sd_error, "time_constant_s": tau_error},
        confidence(
            [other - PARAMETER_PENALTY - seen.cost for other in others], white - seen.cost - THRESHOLD - PER_PARAMETER
        ),
        path_m,
        seen_for,
    )


def _gains_of_others(seen: _Seen, ranges: RangeRows, time_s: Array, rows: Mask) -> Iterator[float]:
    """Yield the falls of the cost of white noise by errors that look alike where a log is not varied enough.

    One of them drifts in proportion to the distance, as a scale does. The others are any functions of a covariate other
    than time, of each sensor or of all of them: along it, they have the same likelihood as a random drift has along
    time. Their white noise may have any size, as that to which each is compared has, while that beside the drift is at
    most twice the stated one. So a rival is never less likely than with the same limit: what a large noise explains as
    well is not named a drift.
    """
    for covariate in ranges.covariates:
        known = rows & np.isfinite(covariate.values)
        if not known.any():
            continue
        for at, lengths in coordinates(covariate):
            for along in (ranges.of_sensor(at), at) if ranges.sensors > 1 else (at,):
                series = RangeSeries.of(seen.fit, ranges, along, known)
                yield _gain(series, likelihoods(series.at, series.residual_m, series.sd_m, lengths, RATIOS))
        if covariate.name == DISTANCE:
            share = np.where(known, covariate.values, 1.0)
            relative = replace(seen.fit, sd=_over(seen.fit.sd, ranges.place, share))
            series = RangeSeries.of(relative, ranges, time_s, known & (share > 0.0))
            likely = likelihoods(series.at, series.residual_m, series.sd_m, seen.times_s, RATIOS)
            yield _gain(series, likely)


def _over(values: Array, place: NDArray[np.int64], divisor: Array) -> Array:
    """Return values (N,) of which those of one quantity are divided by numbers (n,)."""
    divided = values.copy()
    divided[place] /= divisor
    return divided


def _gain(series: RangeSeries, likely: Likelihoods) -> float:
    """Return the fall of the cost of white noise by an error beside it."""
    return series.cost_of(float(series.z @ series.z)) - float(likely.costs.min())


def _warms_up(fit: HypothesisFit) -> bool:
    return any(effect.kind is WarmupDrift for effect in fit.hypothesis.effects)


def _short(seen: _Seen, row_s: float) -> Iterator[float]:
    """Yield the costs of noise that is correlated over few rows and has hardly any white part.

    It is no larger than noise can be; a larger error is a drift.
    """
    series, times_s = seen.series, np.array(SHORT) * row_s
    most = seen.greatest_level / float(WITHOUT_WHITE[0])
    likely = likelihoods(series.at, series.residual_m, series.sd_m, times_s, WITHOUT_WHITE, greatest_level=most)
    yield from likely.costs[:, 0].tolist()


def _jump(series: RangeSeries) -> float:
    """Return the cost of an offset of one path that changes once, at the best moment."""
    falls = [_fall_by_jump(series.z[inside], series.sd_m[inside]) for inside in _each_path(series)]
    return series.cost_of(float(series.z @ series.z) - max(falls))


def _fall_by_jump(z: Array, sd: Array) -> float:
    """Return the fall of the sum of squares by the means before and after the best moment."""
    if len(z) <= 2 * JUMP_ROWS + 1:
        return 0.0
    weight, weighed = np.cumsum(sd**-2.0), np.cumsum(z / sd)
    before, after = weighed[:-1] ** 2 / weight[:-1], (weighed[-1] - weighed[:-1]) ** 2 / (weight[-1] - weight[:-1])
    return float((before + after)[JUMP_ROWS:-JUMP_ROWS].max())


def _lines(series: RangeSeries) -> Array:
    """Return a constant and a line in time (n, 2 K) for each of the K paths."""
    columns = [inside * (series.at - series.at[inside].mean()) ** k for inside in _each_path(series) for k in (0, 1)]
    return np.stack(columns, axis=1)


def _each_path(series: RangeSeries) -> Iterator[Mask]:
    for number in np.unique(series.path):
        yield series.path == number


def _left(z: Array, columns: Array) -> float:
    """Return the sum of squares that the columns leave."""
    rest = z - columns @ np.linalg.lstsq(columns, z, rcond=None)[0]
    return float(rest @ rest)


def _mean_and_error(values: Array, weight: Array) -> tuple[float, float]:
    """Return the geometric mean of positive numbers, and its standard error."""
    logarithms = np.log(values)
    mean = float((weight * logarithms).sum())
    spread = float(np.sqrt((weight * (logarithms - mean) ** 2).sum()))
    return float(np.exp(mean)), float(np.exp(mean)) * spread

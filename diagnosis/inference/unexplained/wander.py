"""Test whether the structure that a range sensor shows over time is a slow, wandering error, and how large that is.

A wandering error is random: it has a standard deviation and a time constant, and no law. Its name stands only if its
likelihood beats that of all that looks like it: white noise, a linear drift, a jump at one moment, and noise that is
correlated over few rows. The likelihood is that of a first-order Gauss-Markov error beside white noise, with the error
itself integrated out (Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, eq. 2.30).
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fit import HypothesisFit
from diagnosis.inference.rivals import confidence
from diagnosis.inference.selection import PER_PARAMETER, THRESHOLD, TOLL
from diagnosis.inference.unexplained.adequacy import LEVEL, Adequacy
from diagnosis.predictors.base import ROW_TIME
from sensors.effects.range_wander import RangeWander
from sensors.effects.warmup_drift import WarmupDrift
from symolo.core.arrays import Array

READING = "reading_m"
OUTLIER = 4.0
"""Residual in sigmas from which a row is left out."""
MIN_ROWS, MAX_ROWS = 40, 400
"""Fewest rows, and number of rows from which neighbours are averaged, since the time grows with its third power."""
MIN_LASTING_ROWS = 5.0
"""Least time constant in rows; noise that is correlated over fewer rows does not wander."""
SHORT = (0.3, 0.6, 1.0, 1.5, 2.0, 3.0)
"""Time constants of correlated noise, in rows."""
JUMP_ROWS = 4
"""Rows at either end between which an offset may jump."""
RATIOS = np.geomspace(0.01, 30.0, 40)
"""Variance of the wandering error over that of the white noise."""
TIMES = 12
"""Number of time constants that are tried, from the least one to the length of the measurement."""
LIMITS = RangeWander.parameters()["time_constant_s"]
"""Least and greatest time constant of the effect, which hold for rows of any distance."""


@dataclass(frozen=True)
class Wander:
    """A wandering error of a range sensor."""

    effect: RangeWander
    std: dict[str, float]
    confidence: float
    path_m: Array
    """(N,), the most probable error at each sample; 0 outside the quantity. Held-out rows were not used for it."""
    span_s: tuple[float, float]
    """First and last time at which it was seen."""

    def answer(self) -> dict[str, object]:
        """Return the error in GAP_FORMAT, ready for JSON."""
        return {
            "name": self.effect.name,
            "parameters": self.effect.model_dump(),
            "std": self.std,
            "confidence": round(self.confidence, 4),
            "ambiguous_with": [],
            "range": {ROW_TIME: list(self.span_s)},
        }


def wander(evidence: Evidence, fit: HypothesisFit, result: Adequacy) -> Wander | None:
    """Return the wandering error that a reading shows over time; None if anything else explains it.

    Args:
        evidence: The observations.
        fit: The fit with the selected effects.
        result: The test of its residuals.
    """
    if not any(s.is_over_time and s.p < LEVEL and s.observed == READING for s in result.structures):
        return None
    # A drift after power-on and a wandering error imitate each other, and each a part of a jump, so that what one of
    # them leaves is no evidence for the other.
    if any(effect.kind is WarmupDrift for effect in fit.hypothesis.effects):
        return None
    number = next(k for k, observed in enumerate(evidence.observed) if observed.name == READING)
    observed, place = evidence.observed[number], evidence.places[number]
    time_s = next(c.values for c in observed.covariates if c.name == ROW_TIME)
    sd_m, residual_m = fit.sd[place], (fit.z * fit.sd)[place]
    rows = evidence.fit[place] & np.isfinite(time_s) & (np.abs(fit.z[place]) < OUTLIER)
    if np.count_nonzero(rows) < MIN_ROWS:
        return None
    t, rest_m, sd = _blocks(time_s[rows], residual_m[rows], sd_m[rows])
    z, row_s, span_s = rest_m / sd, float(np.median(np.diff(t))), float(np.ptp(t))
    shortest_s, longest_s = max(MIN_LASTING_ROWS * row_s, LIMITS.low), min(span_s, LIMITS.high)
    if not (2.0 * MIN_LASTING_ROWS * row_s < span_s and shortest_s < longest_s):
        return None
    times = np.geomspace(shortest_s, longest_s, TIMES)
    # (TIMES, RATIOS) costs and levels of the white noise.
    costs, levels = (np.array(part) for part in zip(*(_likelihoods(t, z, sd, tau) for tau in times), strict=True))
    cost, rows_count = float(costs.min()), len(z)
    white = rows_count * float(np.log(np.mean(z**2)))
    drift = rows_count * float(np.log(_left(z, np.stack([1.0 / sd, t / sd], axis=1)) / rows_count))
    others = [drift, _jump(t, z, sd) + TOLL, min(_short(t, z, row_s))]
    if min(white, drift) - cost < THRESHOLD + PER_PARAMETER or min(others) - cost < TOLL:
        return None
    weight = np.exp(-0.5 * (costs - cost))
    weight /= weight.sum()
    middle_m = float(np.median(sd))
    (sd_of, sd_error), (tau, tau_error) = (
        _mean_and_error(values, weight)
        for values in (middle_m * np.sqrt(levels * RATIOS), np.broadcast_to(times[:, None], weight.shape))
    )
    best = np.unravel_index(int(costs.argmin()), costs.shape)
    path_m = np.zeros(len(evidence.values))
    at = np.where(np.isfinite(time_s), time_s, t[0])
    among, on = (_correlation(times_s, t, float(times[best[0]])) for times_s in (t, at))
    # The mean of the error, given the residuals (eq. 2.23 of the same book).
    noise = np.diag((sd / middle_m) ** 2 / RATIOS[best[1]])
    path_m[place] = on @ np.linalg.solve(among + noise, rest_m)
    return Wander(
        RangeWander(sd_m=min(sd_of, 0.1), time_constant_s=tau),
        {"sd_m": sd_error, "time_constant_s": tau_error},
        confidence([other - cost for other in others], white - cost - THRESHOLD - PER_PARAMETER),
        path_m,
        (float(t.min()), float(t.max())),
    )


def _blocks(t: Array, residual_m: Array, sd_m: Array) -> tuple[Array, Array, Array]:
    """Return times, residuals and their noise in order of time, as means over neighbours if there are many."""
    order = np.argsort(t, kind="stable")
    begins = np.arange(0, len(t), -(-len(t) // MAX_ROWS))
    weight = sd_m[order] ** -2.0
    total = np.add.reduceat(weight, begins)
    mean_s, mean_m = (np.add.reduceat(weight * values[order], begins) / total for values in (t, residual_m))
    return mean_s, mean_m, total**-0.5


def _correlation(t: Array, other: Array, tau: float) -> Array:
    return np.exp(-np.abs(t[:, None] - other[None, :]) / tau)


def _likelihoods(t: Array, z: Array, sd: Array, tau: float) -> tuple[Array, Array]:
    """Return -2 log-likelihood and variance of the white noise for each of RATIOS, with the best such variance."""
    scale = np.median(sd) / sd
    values, vectors = np.linalg.eigh(_correlation(t, t, tau) * np.outer(scale, scale))
    spread = 1.0 + RATIOS[:, None] * np.maximum(values, 0.0)
    level = ((vectors.T @ z) ** 2 / spread).mean(axis=1)
    return len(z) * np.log(level) + np.log(spread).sum(axis=1), level


def _short(t: Array, z: Array, row_s: float) -> Iterator[float]:
    """Yield the costs of noise that is correlated over few rows and has no white part."""
    for rows in SHORT:
        values, vectors = np.linalg.eigh(_correlation(t, t, rows * row_s))
        values = np.maximum(values, 1e-9)
        yield len(z) * float(np.log(((vectors.T @ z) ** 2 / values).mean())) + float(np.log(values).sum())


def _jump(t: Array, z: Array, sd: Array) -> float:
    """Return the cost of an offset that changes once, at the best moment."""
    order = np.argsort(t, kind="stable")
    weight, weighed = np.cumsum(sd[order] ** -2.0), np.cumsum(z[order] / sd[order])
    # The means before and after each moment take these squares.
    before, after = weighed[:-1] ** 2 / weight[:-1], (weighed[-1] - weighed[:-1]) ** 2 / (weight[-1] - weight[:-1])
    left = float(z @ z) - float((before + after)[JUMP_ROWS:-JUMP_ROWS].max())
    return len(z) * float(np.log(left / len(z)))


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

"""Test whether range sensors have a random drift, and how large that is.

The drift (effect `range_wander`) has a standard deviation and a time constant, and no law. Its name stands only if its
likelihood beats that of all that looks like it: white noise, a drift after power-on, a linear drift, a jump at one
moment, noise that is correlated over few rows, a scale that drifts randomly, and any smooth function of another
covariate. The likelihood is that of a first-order Gauss-Markov error beside white noise, with the error itself
integrated out (`diagnosis.inference.unexplained.drift.gauss_markov`).

It imitates a drift after power-on, an offset, and structure along anything that changes slowly. So the selected effects
are weighed again beside it: what it explains by itself is no effect. Where the rows of a bench do not distinguish it
from one of them, both are reported.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from configs.effects.base import Slot
from diagnosis.inference.evidence.drift_memory import DriftMemory
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.selection.penalty import PARAMETER_PENALTY, parameter_penalty
from diagnosis.inference.selection.refusal import is_of_noise, needed
from diagnosis.inference.selection.removal import without
from diagnosis.inference.selection.rivals import AS_GOOD, confidence
from diagnosis.inference.unexplained.drift.rivals import RATIOS
from diagnosis.inference.unexplained.drift.search import DriftFit, DriftSearch
from sensors.effects.range_sensor.range_wander import RangeWander
from sensors.effects.range_sensor.warmup_drift import WarmupDrift
from symolo.core.arrays import Array

NUMBERS = 2
"""Numbers of the drift."""
SURE = 0.95
"""Probability of the shortest time constant, a few fitted rows, from which the error counts as correlated noise."""
EQUAL = 1e-6
"""Difference of the cost that is only rounding error."""


@dataclass(frozen=True)
class RandomDrift:
    """A random drift of a range sensor."""

    effect: RangeWander
    std: dict[str, float]
    confidence: float
    path_m: Array
    """(N,), the most probable error at each sample, given the fitted rows; 0 outside the quantity. Held-out rows
    have no part in it, so that they can judge the effects; the error that it cannot predict stays in them."""
    memory: DriftMemory | None
    """What it carries over from row to row on a bench; None in a time series, from which the path is taken out."""
    seen_for: dict[str, list[float]]
    """First and last time [s] at which it was seen, by the name of the time."""
    ambiguous_with: tuple[str, ...] = ()
    """Effects in the place of which it is, and that explain the rows nearly as well."""

    def answer(self) -> dict[str, object]:
        """Return the error in GAP_FORMAT, ready for JSON."""
        return {
            "name": self.effect.name,
            "parameters": self.effect.model_dump(),
            "std": self.std,
            "confidence": round(self.confidence, 4),
            "ambiguous_with": list(self.ambiguous_with),
            "range": self.seen_for,
        }


def random_drift(evidence: Evidence, nominal: HypothesisFit, fit: HypothesisFit) -> RandomDrift | None:
    """Return the random drift that a reading shows over time; None if anything else explains it.

    Args:
        evidence: The observations.
        nominal: The fit without effects.
        fit: The fit with the selected effects.
    """
    search = DriftSearch.from_fit(evidence, fit)
    if search is None:
        return None
    seen, white = search.beside(fit), search.cost_of_white_noise(fit)
    # A drift after power-on and a random drift imitate each other; on a bench, so may any effect.
    may_be_imitated = bool(fit.hypothesis.effects) if search.is_bench else _warms_up(fit)
    if white - seen.cost < search.needed and not may_be_imitated:
        return None
    search = search.with_drifted_rows(seen)
    seen, white = search.beside(fit), search.cost_of_white_noise(fit)
    seen = _weighed(search, seen)
    if seen.shares.sum(axis=1)[0] > SURE:  # the noise may be correlated over still fewer rows
        return None
    left_out = [effect for effect in fit.hypothesis.effects if effect not in seen.fit.hypothesis.effects]
    instead = white + parameter_penalty(fit) - parameter_penalty(seen.fit) - NUMBERS * PARAMETER_PENALTY - seen.cost
    others = [other - seen.cost for other in search.costs_of_rivals(seen, nominal)]
    # White noise that is larger than stated has a name, so that a drift must only be more likely.
    others.append(search.cost_of_white_noise(seen.fit) - seen.cost)
    white = search.cost_of_white_noise(seen.fit, as_stated=search.is_bench)
    best_without = white if search.is_bench else min(white, search.cost_of_line(seen))
    # At one distance an error of the scale is equally likely, and rounding would decide about the name.
    if best_without - seen.cost < search.needed or min(others) < PARAMETER_PENALTY - EQUAL:
        return None
    if left_out and instead < (0.0 if len(left_out) == 1 and search.is_bench else PARAMETER_PENALTY - EQUAL):
        return None
    # What is no drift must count above, where it would show another cause; in the fits beside the drift it must not.
    regular = search.without_outliers(seen)
    return _named(search, seen, regular.memory(regular.beside(seen.fit)), others, white, left_out, instead)


def rise_with_drift(evidence: Evidence, fit: HypothesisFit, effect: CandidateEffect) -> float:
    """Return the rise of the cost by a random drift in the place of one effect of a fit to a bench.

    It is infinite where the rows cannot show a drift, or have one already.
    """
    search = DriftSearch.from_fit(evidence, fit) if evidence.memory is None else None
    if search is None or not search.is_bench:
        return np.inf
    seen = search.beside(without(evidence, fit, effect))
    numbers = NUMBERS - len(effect.coordinates)
    return seen.cost - search.cost_of_white_noise(fit) + PARAMETER_PENALTY * numbers


def _weighed(search: DriftSearch, seen: DriftFit) -> DriftFit:
    """Return the fit with those effects that the readings need beside a random drift."""
    falls = _falls(seen)
    # Where an effect stands for the drift, hardly any drift is left beside it, which would make the effect significant.
    weak = {effect: fall - needed(effect) for effect, fall in falls.items() if fall < needed(effect) or search.is_bench}
    for effect in sorted(weak, key=lambda effect: weak[effect]):
        fit = without(search.evidence, seen.fit, effect)
        fewer = search.beside(fit if effect.kind.slot is Slot.RANGE_NOISE else _with_noise_of(seen.fit, fit))
        # The standard errors of an effect that is not linear may be far too large, so that the costs decide. Both count
        # the samples of other quantities that are no outliers with the effect.
        cost_without = fewer.joint_cost(search.elsewhere(fewer.fit, seen.fit))
        cost_with = seen.joint_cost(search.elsewhere(seen.fit, seen.fit))
        if cost_without - cost_with < needed(effect):
            return _weighed(search, fewer)
    return seen


def _with_noise_of(other: HypothesisFit, fit: HypothesisFit) -> HypothesisFit:
    """Return a fit whose residuals are in sigmas of another one.

    Without an effect of one sensor, a fit takes its drift for white noise and gives it the more noise, which would then
    count against a drift of all sensors.
    """
    unit = fit.sd / other.sd
    return replace(fit, z=fit.z * unit, sd=other.sd, slopes=fit.slopes * unit, noise=other.noise)


def _falls(seen: DriftFit) -> dict[CandidateEffect, float]:
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


def _named(  # noqa: PLR0917 - what the rows say
    search: DriftSearch,
    seen: DriftFit,
    memory: DriftMemory | None,
    others: Sequence[float],
    white: float,
    left_out: Sequence[CandidateEffect],
    instead: float,
) -> RandomDrift:
    """Return the error with the mean of its size and time constant over all that were tried."""
    weight = seen.shares
    middle_m = float(np.median(seen.series.sd_m))
    (sd_of, sd_error), (tau, tau_error) = (
        _mean_and_error(values, weight)
        for values in (
            middle_m * np.sqrt(seen.likelihoods.levels * RATIOS),
            np.broadcast_to(seen.times_s[:, None], weight.shape),
        )
    )
    rises = [*(other - PARAMETER_PENALTY for other in others), *([instead] if left_out else [])]
    path_m = np.zeros(len(search.evidence.values))
    path_m[search.ranges.place] = seen.path(seen.series, search.time_s)
    known_s = search.ranges.time_s[search.rows]
    return RandomDrift(
        RangeWander(sd_m=min(sd_of, 0.1), time_constant_s=tau),
        {"sd_m": sd_error, "time_constant_s": tau_error},
        confidence(rises, white - seen.cost - search.needed),
        path_m,
        memory,
        {search.ranges.time: [float(known_s.min()), float(known_s.max())]},
        tuple(effect.name for effect in left_out) if instead < AS_GOOD and len(left_out) == 1 else (),
    )


def _warms_up(fit: HypothesisFit) -> bool:
    return any(effect.kind is WarmupDrift for effect in fit.hypothesis.effects)


def _mean_and_error(values: Array, weight: Array) -> tuple[float, float]:
    """Return the geometric mean of positive numbers, and its standard error."""
    logarithms = np.log(values)
    mean = float((weight * logarithms).sum())
    spread = float(np.sqrt((weight * (logarithms - mean) ** 2).sum()))
    return float(np.exp(mean)), float(np.exp(mean)) * spread

"""Intervals of an effect's numbers from the profile of the cost: how far a number may go, all else fitted anew.

A standard error speaks of a parabola. Where the cost rises faster to one side, as near a bound or along a bent valley,
the interval is that of the numbers whose cost, minimised over everything else, rises by no more than a quantile of
chi-squared with one degree of freedom (Venzon and Moolgavkar, Appl. Statist. 37 (1988) 87-94). The cost is a robust
one; of M-estimators the rise is distributed as chi-squared times E psi^2 / E psi' (Heritier and Ronchetti, J. Am. Stat.
Assoc. 89 (1994) 897-904), here over standard normal residuals; that of the priors, which are squares, as it is.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from diagnosis.inference.coordinate import Coordinate
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fit import Fit, fits
from diagnosis.inference.likelihood import CORNER, mean_over_normal
from symolo.core.arrays import Array

LEVELS = (0.68, 0.95)
ROUNDS = 4
"""Fits of each end: the first where a parabola has it, the others where a parabola through what was found has it."""
CLOSE = 0.05
"""Share of the rise to which an end is found: a fortieth of the interval's half width."""
FURTHEST = 3.0
"""Times the last distance, to which an end is looked for next."""


ROBUST: float = mean_over_normal(lambda z: (z / (1.0 + (z / CORNER) ** 2)) ** 2) / mean_over_normal(
    lambda z: (1.0 - (z / CORNER) ** 2) / (1.0 + (z / CORNER) ** 2) ** 2
)
"""E psi^2 / E psi' of the Cauchy loss."""


@dataclass(frozen=True)
class Interval:
    """Of one number of an effect, in its unit."""

    level: float
    low: float
    high: float
    is_open: bool
    """Whether an end is the number's own bound, which the data do not rule out."""


@dataclass
class _End:
    """One end that is looked for."""

    place: int
    level: float
    direction: float
    rise: float
    """Wanted."""
    reach: float
    """Coordinates from the fit, at which it is tried next."""
    bound: float
    """Reach of the number's bound."""
    is_done: bool = False
    is_open: bool = False


def profiles(evidence: Evidence, fit: Fit) -> dict[str, dict[str, tuple[Interval, ...]]]:
    """By effect and number, an interval of each of LEVELS; only of numbers that the data hold."""
    places = {place: of for effect in fit.hypothesis.effects for place, of in _numbers(fit, effect.name)}
    ends = [end for place in places for end in _ends(fit, place)]
    for _ in range(ROUNDS):
        wanted = [end for end in ends if not end.is_done]
        if not wanted:
            break
        found = fits(evidence, [_start(fit, end) for end in wanted])
        for end, held in zip(wanted, found, strict=True):
            _learn(end, _rise(held, fit))
    made: dict[str, dict[str, tuple[Interval, ...]]] = {}
    for place, (effect, coordinate) in places.items():
        own = [end for end in ends if end.place == place]
        if own:
            made.setdefault(effect, {})[coordinate.name] = tuple(_intervals(fit, coordinate, own))
    return made


def _numbers(fit: Fit, name: str) -> list[tuple[int, tuple[str, Coordinate]]]:
    (effect,) = (e for e in fit.hypothesis.effects if e.name == name)
    first = fit.hypothesis.parameters(effect).start
    return [(first + k, (name, of)) for k, of in enumerate(effect.coordinates)]


def _ends(fit: Fit, place: int) -> list[_End]:
    """Both ends at each level, where a parabola has them."""
    variance = float(fit.covariance[place, place])
    if not 0.0 < variance < np.inf:
        return []
    coordinate, x = fit.hypothesis.coordinates[place], float(fit.x[place])
    found = []
    for level in LEVELS:
        quantile = float(chdtri(1, 1.0 - level))
        for direction, bound in ((-1.0, x - coordinate.low), (1.0, coordinate.high - x)):
            reach = min(np.sqrt(quantile * variance), bound)
            end = _End(place, level, direction, quantile, float(reach), bound)
            end.is_done = end.is_open = bound <= 0.0
            found.append(end)
    return found


def _start(fit: Fit, end: _End) -> tuple:
    """The hypothesis with one number held, and the coordinates to which a parabola moves the others."""
    covariance = np.where(np.isfinite(fit.covariance), fit.covariance, 0.0)
    step = end.direction * end.reach
    x: Array = fit.x + covariance[end.place] / covariance[end.place, end.place] * step
    return fit.hypothesis.with_held(end.place, float(fit.x[end.place] + step)), x


def _rise(held: Fit, fit: Fit) -> float:
    """Of the cost, as chi-squared."""
    of_prior = held.prior_cost - fit.prior_cost
    return (held.cost - fit.cost - of_prior) / ROBUST + of_prior


def _learn(end: _End, rise: float) -> None:
    """From the rise at the reach that was tried, where to try next."""
    if abs(rise - end.rise) < CLOSE * end.rise:
        end.is_done = True
    elif rise < end.rise and end.reach >= end.bound:
        end.is_done = end.is_open = True
    else:
        share = np.sqrt(end.rise / max(rise, 1e-9))
        end.reach = min(end.reach * float(np.clip(share, 1.0 / FURTHEST, FURTHEST)), end.bound)


def _intervals(fit: Fit, coordinate: Coordinate, ends: Sequence[_End]) -> list[Interval]:
    found = []
    for level in LEVELS:
        below, above = (end for end in ends if end.level == level)
        x = float(fit.x[below.place])
        shared = 0.0 if fit.shared is None else float(fit.shared[below.place, below.place])
        reaches = [min(np.hypot(end.reach, np.sqrt(end.rise * max(shared, 0.0))), end.bound) for end in (below, above)]
        values = [
            float(coordinate.value(np.array(x + end.direction * reach)))
            for end, reach in zip((below, above), reaches, strict=True)
        ]
        found.append(Interval(level, min(values), max(values), below.is_open or above.is_open))
    return found

"""Profile intervals of an effect's parameters: how far a parameter may move with all else fitted again.

A standard error describes a parabola. Where the cost rises faster on one side, as near a bound or along a bent valley,
the interval holds the values whose cost, minimised over everything else, rises by no more than a quantile of
chi-squared with one degree of freedom (Venzon and Moolgavkar, Appl. Statist. 37 (1988) 87-94).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.coordinate import Coordinate
from diagnosis.inference.fitting.fit import HypothesisFit, fits
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis
from symolo.core.arrays import Array

LEVELS = (0.68, 0.95)
ROUNDS = 4
"""Fits for each end: the first where a parabola has it, the others where a parabola through the last result has it."""
TOLERANCE = 0.05
"""Share of the rise to which an end is determined: a fortieth of the interval's half width."""
MAX_FACTOR = 3.0
"""Largest change of an end from one fit to the next, as a factor."""


@dataclass(frozen=True)
class Interval:
    """Interval of one parameter of an effect, in its unit."""

    level: float
    low: float
    high: float
    is_open: bool
    """Whether an end is the bound of the parameter, which the data do not rule out."""


@dataclass
class _End:
    """One end of an interval that is being determined."""

    place: int
    level: float
    direction: float
    rise: float
    """Rise of the cost at the end."""
    reach: float
    """Distance from the fit, in coordinates, at which the next fit is made."""
    bound: float
    """Distance of the parameter's bound from the fit."""
    is_done: bool = False
    is_open: bool = False

    def update(self, rise: float) -> None:
        """Set the next reach from the rise at the last one."""
        if abs(rise - self.rise) < TOLERANCE * self.rise:
            self.is_done = True
        elif rise < self.rise and self.reach >= self.bound:
            self.is_done = self.is_open = True
        else:
            # The rise of a parabola grows with the square of the distance.
            factor = float(np.clip(np.sqrt(self.rise / max(rise, 1e-9)), 1.0 / MAX_FACTOR, MAX_FACTOR))
            self.reach = min(self.reach * factor, self.bound)


def profiles(
    evidence: Evidence,
    fit: HypothesisFit,
    levels: Sequence[float] = LEVELS,
    effects: Sequence[CandidateEffect] | None = None,
) -> dict[str, dict[str, tuple[Interval, ...]]]:
    """Return an interval for each level by effect and parameter, for the parameters that the data determine.

    Args:
        evidence: The observations.
        fit: The fit.
        levels: Probabilities of the intervals.
        effects: Effects of the fit; all by default.
    """
    hypothesis = fit.hypothesis
    places = {
        place: (effect.name, coordinate)
        for effect in (hypothesis.effects if effects is None else effects)
        for place, coordinate in enumerate(effect.coordinates, hypothesis.parameters(effect).start)
    }
    ends = [end for place in places for end in _ends(fit, place, levels)]
    for _ in range(ROUNDS):
        open_ends = [end for end in ends if not end.is_done]
        if not open_ends:
            break
        fixed_fits = fits(evidence, [_start(fit, end) for end in open_ends])
        for end, fixed in zip(open_ends, fixed_fits, strict=True):
            end.update(fixed.cost - fit.cost)
    intervals: dict[str, dict[str, tuple[Interval, ...]]] = {}
    for place, (effect, coordinate) in places.items():
        if both_ends := [end for end in ends if end.place == place]:
            intervals.setdefault(effect, {})[coordinate.name] = tuple(_intervals(fit, coordinate, both_ends))
    return intervals


def _ends(fit: HypothesisFit, place: int, levels: Sequence[float]) -> list[_End]:
    """Return both ends at each level, where a parabola has them."""
    variance = float(fit.covariance[place, place])
    if not 0.0 < variance < np.inf:
        return []
    coordinate, x = fit.hypothesis.coordinates[place], float(fit.x[place])
    ends = []
    for level in levels:
        quantile = float(chdtri(1, 1.0 - level))
        for direction, bound in ((-1.0, x - coordinate.low), (1.0, coordinate.high - x)):
            reach = float(min(np.sqrt(quantile * variance), bound))
            at_bound = bound <= 0.0
            ends.append(_End(place, level, direction, quantile, reach, bound, is_done=at_bound, is_open=at_bound))
    return ends


def _start(fit: HypothesisFit, end: _End) -> tuple[Hypothesis, Array]:
    """Return the hypothesis with one coordinate fixed, and the coordinates to which a parabola moves the others."""
    covariance = np.where(np.isfinite(fit.covariance), fit.covariance, 0.0)
    step = end.direction * end.reach
    x = fit.x + covariance[end.place] / covariance[end.place, end.place] * step
    return fit.hypothesis.with_fixed(end.place, float(fit.x[end.place] + step)), x


def _intervals(fit: HypothesisFit, coordinate: Coordinate, ends: Sequence[_End]) -> list[Interval]:
    intervals = []
    for level in dict.fromkeys(end.level for end in ends):
        both = [end for end in ends if end.level == level]
        x, place = float(fit.x[both[0].place]), both[0].place
        # Errors that samples share are no part of the cost; their variance is added to the squared reach.
        shared = 0.0 if fit.shared is None else max(float(fit.shared[place, place]), 0.0)
        reaches = [min(np.hypot(end.reach, np.sqrt(end.rise * shared)), end.bound) for end in both]
        values = [
            float(coordinate.value(np.array(x + end.direction * reach)))
            for end, reach in zip(both, reaches, strict=True)
        ]
        intervals.append(Interval(level, min(values), max(values), any(end.is_open for end in both)))
    return intervals

"""A first look at every candidate: how much would the cost fall, were it added to what is fitted already?

Each effect is switched on at several sizes and shapes, and one prediction of each tells two things: the cost itself as
it stands, and, by the change of the prediction taken as a direction, how far it would fall at the best size after all
fitted numbers have moved along (the score test of Rao with a chord in place of the tangent, since dead zones, limits
and play have no slope at nothing). Full fits follow for the promising ones alone.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from diagnosis.inference.coordinate import Coordinate
from diagnosis.inference.evidence.evidence import Evidence, Prediction
from diagnosis.inference.fit import Fit
from diagnosis.inference.hypothesis import CandidateEffect, Hypothesis, moved
from diagnosis.inference.likelihood import costs_of_residuals, robust_weight, sample_costs
from diagnosis.inference.projection import orthonormal
from symolo.core.arrays import Array

SIZES = (1.0, 0.25, -0.25, -1.0)
"""Of the start value's distance from the null value; those beyond a bound are left out."""
OF_TIMES = (*SIZES, 0.06)
"""The same of a delay or a lag."""
SHAPES = (0.1, 0.3, 1.0, 3.0, 10.0)
"""Times the start value, of a shape."""
CEILINGS = tuple(np.geomspace(0.1, 10.0, 25).tolist())
"""Times the start value, of a limit, which does nothing where it is a little too high and much where too low."""
FURTHEST = 4.0
"""Times the size tried, to which a straight line is believed."""
NOTHING = 1e-12
"""Share of a change's square beyond all that is fitted, up to which it is that of rounding."""


@dataclass(frozen=True, eq=False)
class Prospect:
    """One effect on top of a fit."""

    effect: CandidateEffect
    start: Array
    """Coordinates of the fit's hypothesis with the effect, (P,)."""
    drop: float
    """Of the cost, expected from the start's prediction."""


def scan(evidence: Evidence, fit: Fit, effects: Sequence[CandidateEffect]) -> list[Prospect]:
    """The best prospect of each effect, the most promising first."""
    if not effects:
        return []
    tries = [(effect, numbers) for effect in effects for numbers in _tries(effect)]
    hypotheses = {effect: fit.hypothesis.with_effect(effect) for effect in effects}
    starts = [_placed(hypotheses[effect], fit, effect, numbers) for effect, numbers in tries]
    robots = [hypotheses[effect].robot(x) for (effect, _), x in zip(tries, starts, strict=True)]
    here = costs_of_residuals(evidence, fit.z, fit.sd)
    there = evidence.of(robots)
    drops, sizes = _along_lines(evidence, fit, there.mean)
    best: dict[CandidateEffect, Prospect] = {}
    for k, ((effect, _), x) in enumerate(zip(tries, starts, strict=True)):
        only = Prediction(there.mean[k : k + 1], there.sd[k : k + 1])
        at_once = float((here - sample_costs(evidence, only)[0])[evidence.fit].sum())
        drop, size = float(drops[k]), float(sizes[k])
        found = Prospect(effect, x, at_once)
        if drop > at_once:
            found = Prospect(effect, _scaled(hypotheses[effect], effect, x, size), drop)
        if effect not in best or found.drop > best[effect].drop:
            best[effect] = found
    return sorted(best.values(), key=lambda prospect: -prospect.drop)


def _along_lines(evidence: Evidence, fit: Fit, means: Array) -> tuple[Array, Array]:
    """Falls of the cost at the best multiples of changes of the prediction, all that is fitted moving along.

    Args:
        evidence: What was observed.
        fit: What is fitted already.
        means: (M, N), predictions with the changes.

    Returns:
        The falls and the multiples, (M,) each.
    """
    root = np.where(evidence.fit, np.sqrt(evidence.weight * robust_weight(fit.z)), 0.0)
    rows = np.flatnonzero(evidence.fit)
    changes = root[rows] * ((means - evidence.values + fit.z * fit.sd) / fit.sd)[:, rows]
    changes = np.where(np.isfinite(changes), changes, 0.0)
    basis, residual = orthonormal(fit.tangents(root)), fit.left(fit.z, root)
    taken = changes @ basis[rows]
    squares = (changes**2).sum(axis=1) - (taken**2).sum(axis=1)
    along = changes @ residual[rows] - taken @ (basis.T @ residual)
    given = squares > NOTHING * (changes**2).sum(axis=1)
    sizes = np.clip(np.divide(along, squares, out=np.zeros_like(along), where=given), 0.0, FURTHEST)
    return np.where(given, 2.0 * sizes * along - sizes**2 * squares, 0.0), sizes


def _tries(effect: CandidateEffect) -> Iterator[tuple[float, ...]]:
    """Coordinates of an effect's numbers to look at."""
    yield from product(*(_values(coordinate) for coordinate in effect.coordinates))


def _values(coordinate: Coordinate) -> list[float]:
    if coordinate.null is None or coordinate.is_ceiling:
        factors = CEILINGS if coordinate.is_ceiling else SHAPES
        found = [coordinate.start + float(np.log(factor)) for factor in factors]
    else:
        found = [
            coordinate.null + size * (coordinate.start - coordinate.null)
            for size in (OF_TIMES if coordinate.is_time else SIZES)
        ]
    return [x for x in found if coordinate.low <= x <= coordinate.high]


def _placed(hypothesis: Hypothesis, fit: Fit, effect: CandidateEffect, numbers: Sequence[float]) -> Array:
    x = moved(fit.x, fit.hypothesis, hypothesis)
    x[hypothesis.parameters(effect)] = numbers
    return x


def _scaled(hypothesis: Hypothesis, effect: CandidateEffect, x: Array, size: float) -> Array:
    """With the amplitudes of the effect that many times as far from nothing."""
    found = x.copy()
    places = hypothesis.parameters(effect)
    for place, coordinate in zip(range(places.start, places.stop), effect.coordinates, strict=True):
        if coordinate.null is not None and not coordinate.is_ceiling:
            found[place] = coordinate.null + size * (x[place] - coordinate.null)
    return hypothesis.clipped(found)

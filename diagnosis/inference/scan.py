"""A first estimate for every candidate effect: how far would the cost fall if the effect were added to a fit?

Each effect is switched on at several sizes and shapes. One prediction of each gives two numbers: the cost as it is,
and the expected fall of the cost at the best size after all fitted parameters have moved too. The second takes the
change of the prediction as a direction (Rao's score test with a chord in place of the tangent, since dead zones, limits
and gear play have no slope at zero). Full fits follow only for the promising effects.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from diagnosis.inference.coordinate import Coordinate
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fit import HypothesisFit
from diagnosis.inference.hypothesis import CandidateEffect, moved
from diagnosis.inference.likelihood import sample_costs
from diagnosis.inference.periodogram import waves
from diagnosis.inference.projection import orthonormal
from symolo.core.arrays import Array

SIZES = (1.0, 0.25, -0.25, -1.0)
"""Sizes relative to the distance of the start value from the null value; those outside the bounds are left out."""
TIME_SIZES = (*SIZES, 0.06)
"""Sizes of a delay or a lag."""
SHAPES = (0.1, 0.3, 1.0, 3.0, 10.0)
"""Factors on the start value of a shape parameter."""
ANGLES = tuple((np.pi / 3.0 * np.arange(-2, 4)).tolist())
"""Directions and phases [rad]: none is further than 30 degrees from one of them."""
CEILINGS = (0.2, 0.35, 0.5, 0.6, 0.7, 0.78, 0.84, 0.88, 0.91, 0.94, 0.96, 0.975, 0.985, 0.992, 0.997)
"""Shares of the samples below a limit that is tried. A limit a little above all samples does nothing, and one that is
too low does much, so that only the samples themselves show where to try."""
MAX_MULTIPLE = 4.0
"""Multiple of the tried size up to which the change is assumed to be linear."""
MIN_SHARE = 1e-12
"""Share of a change's square outside the fitted directions, below which it is only rounding error."""


@dataclass(frozen=True, eq=False)
class Prospect:
    """One effect in addition to a fit."""

    effect: CandidateEffect
    start: Array
    """Coordinates (P,) of the fit's hypothesis with the effect, from which a fit may start."""
    drop: float
    """Expected fall of the cost."""


def scan(evidence: Evidence, fit: HypothesisFit, effects: Sequence[CandidateEffect]) -> list[Prospect]:
    """Return the best prospect of each effect, the most promising first."""
    tries = [(effect, numbers) for effect in effects for numbers in _tries(evidence, fit, effect)]
    if not tries:
        return []
    hypotheses = {effect: fit.hypothesis.with_effect(effect) for effect in effects}
    starts = []
    for effect, numbers in tries:
        x = moved(fit.x, fit.hypothesis, hypotheses[effect])
        x[hypotheses[effect].parameters(effect)] = numbers
        starts.append(x)
    robots = [hypotheses[effect].robot(x) for (effect, _), x in zip(tries, starts, strict=True)]
    costs_before = fit.costs
    predictions = evidence.predicted(robots).moved(fit.local_change)
    drops, sizes = _along_lines(evidence, fit, predictions.mean)
    best: dict[CandidateEffect, Prospect] = {}
    for k, ((effect, _), x) in enumerate(zip(tries, starts, strict=True)):
        single = predictions.some(slice(k, k + 1))
        immediate = float((costs_before - sample_costs(evidence, single, fit.noise)[0])[evidence.fit].sum())
        prospect = Prospect(effect, x, immediate)
        if (drop := float(drops[k])) > immediate:
            prospect = Prospect(effect, hypotheses[effect].scaled(effect, x, float(sizes[k])), drop)
        if effect not in best or prospect.drop > best[effect].drop:
            best[effect] = prospect
    return sorted(best.values(), key=lambda prospect: -prospect.drop)


def _tries(evidence: Evidence, fit: HypothesisFit, effect: CandidateEffect) -> list[tuple[float, ...]]:
    """Return the coordinates of an effect at which it is tried."""
    coordinates = effect.coordinates
    if not any(coordinate.is_frequency for coordinate in coordinates):
        return list(product(*_tried(evidence, effect)))
    tries = []
    for wave in waves(evidence, fit):
        x = [
            wave.cycles_per_turn if c.is_frequency else wave.phase_rad if c.is_angle else wave.amplitude_N_m / c.unit
            for c in coordinates
        ]
        tries.append(tuple(min(max(value, c.low), c.high) for value, c in zip(x, coordinates, strict=True)))
    return tries


def _along_lines(evidence: Evidence, fit: HypothesisFit, means: Array) -> tuple[Array, Array]:
    """Return the falls of the cost at the best multiples of changes, with all fitted parameters moving along.

    Args:
        evidence: The observations.
        fit: The fit without the changes.
        means: (M, N), predictions with the changes.

    Returns:
        The falls and the multiples, (M,) each.
    """
    root = fit.root_weights()
    rows = np.flatnonzero(evidence.fit)
    changes = root[rows] * ((means - evidence.values + fit.z * fit.sd) / fit.sd)[:, rows]
    changes = np.where(np.isfinite(changes), changes, 0.0)
    # The part of a change inside the span of the tangents is what the fitted parameters can explain themselves.
    basis, residual = orthonormal(fit.tangents(root)), fit.weighted_residuals(fit.z, root)
    taken = changes @ basis[rows]
    squares = (changes**2).sum(axis=1) - (taken**2).sum(axis=1)
    along = changes @ residual[rows] - taken @ (basis.T @ residual)
    # A parabola along each direction: 2 along size - squares size^2, with its top at along / squares.
    is_new = squares > MIN_SHARE * (changes**2).sum(axis=1)
    sizes = np.clip(np.divide(along, squares, out=np.zeros_like(along), where=is_new), 0.0, MAX_MULTIPLE)
    return np.where(is_new, 2.0 * sizes * along - sizes**2 * squares, 0.0), sizes


def _tried(evidence: Evidence, effect: CandidateEffect) -> list[list[float]]:
    """Return the coordinates at which each parameter of an effect is tried."""
    units = {name: parameter.unit for name, parameter in effect.kind.parameters().items()}
    return [
        _ceilings(evidence, coordinate, units[coordinate.name]) if coordinate.is_ceiling else tried_values(coordinate)
        for coordinate in effect.coordinates
    ]


def _ceilings(evidence: Evidence, coordinate: Coordinate, unit: str) -> list[float]:
    """Return the coordinates of limits between the samples of the fit with the unit of the limit."""
    of_unit = np.repeat([observed.unit == unit for observed in evidence.observed], evidence.counts)
    sizes = np.abs(evidence.values[of_unit & evidence.fit])
    levels = np.quantile(sizes[sizes > 0.0], CEILINGS) if (sizes > 0.0).any() else np.zeros(0)
    values = [coordinate.coordinate(level) for level in np.unique(levels).tolist()] or [coordinate.start]
    return [x for x in values if coordinate.low <= x <= coordinate.high]


def tried_values(coordinate: Coordinate) -> list[float]:
    """Return the coordinates at which a parameter that is no limit is tried."""
    if coordinate.is_angle:
        return list(ANGLES)
    if coordinate.null is None:
        values = [coordinate.start + float(np.log(factor)) for factor in SHAPES]
    else:
        sizes = (*(TIME_SIZES if coordinate.is_time else SIZES), *coordinate.tries)
        values = [coordinate.null + size * (coordinate.start - coordinate.null) for size in sizes]
    return [x for x in values if coordinate.low <= x <= coordinate.high]

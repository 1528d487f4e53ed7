"""A first estimate for every candidate effect: how far would the cost fall if the effect were added to a fit?

Each effect is switched on at several sizes and shapes. One prediction of each gives two numbers: the cost as it is,
and the expected fall of the cost at the best size after all fitted parameters have moved too. The second takes the
change of the prediction as a direction (Rao's score test with a chord in place of the tangent, since dead zones, limits
and gear play have no slope at zero). Full fits follow only for the promising effects.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np

from configs.effects.base import Slot
from diagnosis.inference.evidence.evidence import Evidence, Prediction
from diagnosis.inference.evidence.memoized import memoized
from diagnosis.inference.fitting.coordinate import Coordinate
from diagnosis.inference.fitting.fit import HypothesisFit, at
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis, moved
from diagnosis.inference.fitting.likelihood import sample_costs
from diagnosis.inference.fitting.projection import orthonormal
from diagnosis.inference.selection.periodogram import waves
from diagnosis.measured.channel import Mask
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
FLOORS = (0.003, 0.01, 0.03, 0.06, 0.12)
"""Shares of the samples below a floor that is tried."""
MAX_MULTIPLE = 4.0
"""Multiple of the tried size up to which the change is assumed to be linear."""
MIN_SHARE = 1e-12
"""Share of a change's square outside the fitted directions, below which it is only rounding error."""
MIN_APART = 1e-3
"""Square of the sine of the angle between two changes, below which a prediction of both says nothing about either."""

Try = tuple[CandidateEffect, tuple[float, ...]]
"""An effect with the coordinates at which it is tried."""


@dataclass(frozen=True, eq=False)
class Prospect:
    """One effect in addition to a fit."""

    effect: CandidateEffect
    start: Array
    """Coordinates (P,) of the fit's hypothesis with the effect, from which a fit may start."""
    drop: float
    """Expected fall of the cost."""


@dataclass(frozen=True, eq=False)
class PairProspect:
    """Two effects in addition to a fit."""

    hypothesis: Hypothesis
    """The fit's hypothesis with both."""
    start: Array
    """(P,), coordinates from which a fit may start."""
    drop: float
    """Expected fall of the cost."""


def scan(evidence: Evidence, fit: HypothesisFit, effects: Sequence[CandidateEffect]) -> list[Prospect]:
    """Return the best prospect of each effect, the most promising first."""
    return scan_beside(evidence, [(fit, effects)])[0]


def scan_beside(
    evidence: Evidence, several: Sequence[tuple[HypothesisFit, Sequence[CandidateEffect]]]
) -> list[list[Prospect]]:
    """Return the best prospect of each effect beside each fit, the most promising first; all in one batch."""
    fits_with_tries = zip(several, _tries_of_all(evidence, several), strict=True)
    prospects = [_prospects(evidence, fit, *tries) for (fit, _), tries in fits_with_tries]
    return [sorted(each, key=lambda prospect: -prospect.drop) for each in prospects]


def _prospects(evidence: Evidence, fit: HypothesisFit, tries: Sequence[Try], predictions: Prediction) -> list[Prospect]:
    """Return the best prospect of each effect."""
    if not tries:
        return []
    rigid = _rigid(evidence, fit)
    costs_before = fit.costs
    lines = _Lines.from_predictions(evidence, rigid.fit, predictions.mean)
    drops, sizes = lines.tops()
    best: dict[CandidateEffect, tuple[Prospect, Array]] = {}
    for k, (effect, numbers) in enumerate(tries):
        hypothesis, x = _extended(fit.hypothesis, fit.x, effect, numbers)
        single = predictions.some(slice(k, k + 1))
        immediate = float((costs_before - sample_costs(evidence, single, fit.noise)[0])[evidence.fit].sum())
        drop, size = immediate, 1.0
        if float(drops[k]) > immediate:
            drop, size = float(drops[k]), float(sizes[k])
            x = hypothesis.scaled(effect, x, size)
        if effect not in best or drop > best[effect][0].drop:
            best[effect] = Prospect(effect, x, drop), size * lines.changes[k]
    if rigid.fit is fit:
        return [prospect for prospect, _ in best.values()]
    return [replace(p, start=_moved_along(evidence, fit, rigid.fit, p, change)) for p, change in best.values()]


@dataclass(frozen=True)
class _Rigid:
    """A fit as a linear model without play in the gear."""

    fit: HypothesisFit
    """The fit, with the slopes of the robot without play; the fit itself if there is no play."""
    change: Array | float
    """(N,), difference of the predictions of the fit from those of its robot, without play."""


@memoized
def _rigid(evidence: Evidence, fit: HypothesisFit) -> _Rigid:
    """Return a fit as a linear model.

    In a gear with play, contacts come and go with any number, so that slopes say nothing about changes that are larger
    than the step of a derivative.
    """
    hypothesis = fit.hypothesis
    effects = tuple(effect for effect in hypothesis.effects if effect.kind.slot is not Slot.GEARBOX)
    if len(effects) == len(hypothesis.effects):
        return _Rigid(fit, fit.whitened_change)
    rigid = replace(hypothesis, effects=effects)
    other = at(evidence, rigid, moved(fit.x, hypothesis, rigid))
    change = other.whitened_change + other.z * other.sd - fit.z * fit.sd
    slopes = other.slopes * other.sd / fit.sd
    return _Rigid(replace(other, z=fit.z, lost=fit.lost, sd=fit.sd, noise=fit.noise, slopes=slopes), change)


def _moved_along(
    evidence: Evidence, fit: HypothesisFit, rigid: HypothesisFit, prospect: Prospect, change: Array
) -> Array:
    """Return the start (P,) of a prospect where all parameters that the linear model has move along.

    Args:
        evidence: The observations.
        fit: The fit.
        rigid: The fit without play.
        prospect: The prospect.
        change: (n,), its weighted change in the rows of the fit.
    """
    root = rigid.root_weights()
    residual = rigid.weighted_residuals(rigid.z, root)
    residual[np.flatnonzero(evidence.fit)] -= change
    shift = np.linalg.lstsq(rigid.tangents(root), residual, rcond=None)[0]
    extended = fit.hypothesis.with_effect(prospect.effect)
    start = moved(rigid.x + shift, rigid.hypothesis, extended)
    for effect in extended.effects:
        if effect not in rigid.hypothesis.effects:
            places = extended.parameters(effect)
            start[places] = prospect.start[places]
    return extended.clipped(start)


def scan_pairs(evidence: Evidence, fit: HypothesisFit, effects: Sequence[CandidateEffect]) -> list[PairProspect]:
    """Return the best prospect of every two effects together, the most promising first.

    Two effects may compensate each other, so that neither explains much alone, and a search that begins with one of
    them misses both.
    """
    ((tries, predictions),) = _tries_of_all(evidence, [(fit, effects)])
    drops, sizes, others = _Lines.from_predictions(evidence, fit, predictions.mean).tops_of_two()
    places: dict[CandidateEffect, list[int]] = {}
    for k, (effect, _) in enumerate(tries):
        places.setdefault(effect, []).append(k)
    prospects = []
    for one, two in combinations(places, 2):
        if one.kind is two.kind:
            continue
        block = drops[np.ix_(places[one], places[two])]
        row, column = np.unravel_index(int(block.argmax()), block.shape)
        if block[row, column] <= 0.0:
            continue
        first, second = places[one][row], places[two][column]
        both, x = fit.hypothesis, fit.x
        for k, size in ((first, sizes[first, second]), (second, others[first, second])):
            both, x = _extended(both, x, *tries[k])
            x = both.scaled(tries[k][0], x, float(size))
        prospects.append(PairProspect(both, x, float(block[row, column])))
    return sorted(prospects, key=lambda prospect: -prospect.drop)


def _extended(
    hypothesis: Hypothesis, x: Array, effect: CandidateEffect, numbers: Sequence[float]
) -> tuple[Hypothesis, Array]:
    """Return a hypothesis with one effect in addition, and its coordinates with those numbers of the effect."""
    extended = hypothesis.with_effect(effect)
    y = moved(x, hypothesis, extended)
    y[extended.parameters(effect)] = numbers
    return extended, y


def _tries_of_all(
    evidence: Evidence, several: Sequence[tuple[HypothesisFit, Sequence[CandidateEffect]]]
) -> list[tuple[list[Try], Prediction]]:
    """Return the effects with the coordinates at which each is tried beside each fit, and the predictions."""
    tries = [[(effect, x) for effect in effects for x in _tries(evidence, fit, effect)] for fit, effects in several]
    robots = []
    rigid = [_rigid(evidence, fit) for fit, _ in several]
    for base, each in zip(rigid, tries, strict=True):
        extended = (_extended(base.fit.hypothesis, base.fit.x, *one) for one in each)
        robots += [hypothesis.robot(x) for hypothesis, x in extended]
    batch = evidence.predicted(robots)
    ends = np.cumsum([len(each) for each in tries]).tolist()
    return [
        (each, batch.some(slice(end - len(each), end)).moved(base.change))
        for base, each, end in zip(rigid, tries, ends, strict=True)
    ]


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


@dataclass(frozen=True, eq=False)
class _Lines:
    """Changes of the predictions as directions, with all fitted parameters moving along."""

    changes: Array
    """(M, n), weighted changes in the rows of the fit."""
    taken: Array
    """(M, P), coordinates of their parts that the fitted parameters can explain themselves, in an orthonormal basis."""
    along: Array
    """(M,), inner products of the other parts with the weighted residuals."""

    @classmethod
    def from_predictions(cls, evidence: Evidence, fit: HypothesisFit, means: Array) -> "_Lines":
        """Return the directions of predictions (M, N) with the changes."""
        root = fit.root_weights()
        rows = np.flatnonzero(evidence.fit)
        changes = root[rows] * ((means - evidence.values + fit.z * fit.sd) / fit.sd)[:, rows]
        changes = np.where(np.isfinite(changes), changes, 0.0)
        # The part of a change inside the span of the tangents is what the fitted parameters can explain themselves.
        basis, residual = orthonormal(fit.tangents(root)), fit.weighted_residuals(fit.z, root)
        taken = changes @ basis[rows]
        return cls(changes, taken, changes @ residual[rows] - taken @ (basis.T @ residual))

    def squares(self) -> tuple[Array, Mask]:
        """Return the squares (M,) of the parts that the fitted parameters cannot explain, and whether they exist."""
        whole = (self.changes**2).sum(axis=1)
        squares = whole - (self.taken**2).sum(axis=1)
        return squares, squares > MIN_SHARE * whole

    def tops(self) -> tuple[Array, Array]:
        """Return the falls of the cost at the best multiples of each change, and the multiples, (M,) each."""
        # A parabola along each direction: 2 along size - squares size^2, with its top at along / squares.
        squares, is_new = self.squares()
        sizes = np.divide(self.along, squares, out=np.zeros_like(self.along), where=is_new)
        sizes = np.clip(sizes, 0.0, MAX_MULTIPLE)
        return np.where(is_new, 2.0 * sizes * self.along - sizes**2 * squares, 0.0), sizes

    def tops_of_two(self) -> tuple[Array, Array, Array]:
        """Return the falls of the cost at the best multiples of every two changes, and both multiples, (M, M) each.

        The fall is 0 for two changes that are hardly distinguishable, and where one of the multiples would be negative.
        """
        squares, is_new = self.squares()
        inner = self.changes @ self.changes.T - self.taken @ self.taken.T
        first, other = np.meshgrid(squares, squares, indexing="ij")
        along, beside = np.meshgrid(self.along, self.along, indexing="ij")
        determinant = first * other - inner**2
        usable = (determinant > MIN_APART * first * other) & is_new[:, None] & is_new
        divisor = np.where(usable, determinant, 1.0)
        sizes = (other * along - inner * beside) / divisor
        others = (first * beside - inner * along) / divisor
        usable &= (sizes > 0.0) & (others > 0.0)
        sizes, others = np.minimum(sizes, MAX_MULTIPLE), np.minimum(others, MAX_MULTIPLE)
        falls = 2.0 * (sizes * along + others * beside)
        falls -= sizes**2 * first + others**2 * other + 2.0 * sizes * others * inner
        return np.where(usable, falls, 0.0), sizes, others


def _tried(evidence: Evidence, effect: CandidateEffect) -> list[list[float]]:
    """Return the coordinates at which each parameter of an effect is tried."""
    return [
        _limits(evidence, effect, coordinate)
        if coordinate.is_ceiling or coordinate.is_floor
        else tried_values(coordinate)
        for coordinate in effect.coordinates
    ]


def starts(evidence: Evidence, effect: CandidateEffect) -> Array:
    """Return coordinates at which an effect should be visible: the start values, and limits between the samples."""
    return np.array([_visible(evidence, effect, coordinate) for coordinate in effect.coordinates])


def _visible(evidence: Evidence, effect: CandidateEffect, coordinate: Coordinate) -> float:
    """Return the start of a coordinate, or of a limit the tried value that most samples exceed or fall below."""
    limits = _limits(evidence, effect, coordinate) if coordinate.is_ceiling or coordinate.is_floor else []
    if not limits:
        return coordinate.start
    return min(limits) if coordinate.is_ceiling else max(limits)


def _limits(evidence: Evidence, effect: CandidateEffect, coordinate: Coordinate) -> list[float]:
    """Return the coordinates of a limit, upper or lower, between the samples of the fit with its unit."""
    unit = effect.kind.parameters()[coordinate.name].unit
    shares = CEILINGS if coordinate.is_ceiling else FLOORS
    has_unit = np.repeat([observed.unit == unit for observed in evidence.observed], evidence.counts)
    sizes = np.abs(evidence.readings[has_unit & evidence.fit])
    levels = np.quantile(sizes[sizes > 0.0], shares) if (sizes > 0.0).any() else np.zeros(0)
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

"""How each effect would show in these data: how far it moves each quantity, and which effects look alike.

Every testable effect is switched on at its start value, on top of the nominal robot, and the change of each prediction
is taken in sigmas. What the tolerances of the nominal parameters could take up is projected out, as in the score test;
the root of what is left, squared and summed, is how many standard errors stand between the effect and nothing, and from
it follows, as on a straight line, the smallest size that these data would show. Two effects whose changes then point
the same way cannot be told apart by these data, whatever is found (isolability: Gertler, Fault Detection and Diagnosis
in Engineering Systems, 1998, ch. 4).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import inf, sqrt

import numpy as np

from diagnosis.inference.coordinate import Coordinate
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fit import Fit
from diagnosis.inference.hypothesis import CandidateEffect
from diagnosis.inference.likelihood import SPREAD
from diagnosis.inference.selection import needed
from symolo.core.arrays import Array

ALIKE = 0.98
"""Cosine from which two changes are one and the same."""
STILL = 1e-3
"""Sigmas below which a quantity does not move."""


@dataclass(frozen=True)
class Signature:
    """Of one effect at its start value."""

    effect: CandidateEffect
    start: str
    """`scale = 1.15`, for the table."""
    moves: tuple[float, ...]
    """Of each observed quantity: root mean square change of the mean [sigma]."""
    spreads: tuple[float, ...]
    """Of each observed quantity: factor on the standard deviation, 1 where it stays."""
    significance: float
    """Standard errors between the start value and nothing, the nuisances fitted anew."""
    smallest: float
    """Distance from nothing, in the unit of the first number, from which these data would name it; inf if never.
    NaN where no straight line leads there, as for a limit that does not act."""


@dataclass(frozen=True)
class Signatures:
    quantities: tuple[str, ...]
    rows: tuple[Signature, ...]
    """The most visible first."""
    alike: tuple[tuple[str, str, float], ...]
    """Names and cosine of effects that point the same way."""


def signatures(evidence: Evidence, nominal: Fit, effects: Sequence[CandidateEffect]) -> Signatures:
    """Of effects, on top of a fit of the nuisances alone.

    Args:
        evidence: What was observed.
        nominal: The fit without effects.
        effects: Those that the data can show.
    """
    base = nominal.hypothesis
    (here,), robots = [base.robot(base.null())], []
    for effect in effects:
        having = base.with_effect(effect)
        robots.append(having.robot(np.array([*base.null(), *(c.start for c in effect.coordinates)])))
    prediction = evidence.of([here, *robots])
    free = _Free(evidence, nominal)
    rows, directions = [], []
    for k, effect in enumerate(effects, 1):
        mean = (prediction.mean[k] - prediction.mean[0]) / prediction.sd[0]
        wider = np.log(prediction.sd[k] / prediction.sd[0])
        mean, wider = (np.where(evidence.fit & np.isfinite(of), of, 0.0) for of in (mean, wider))
        direction = np.concatenate([free.of(mean), sqrt(2.0 * SPREAD) * np.sqrt(evidence.weight) * wider])
        significance = float(np.linalg.norm(direction))
        counts = [max(1, np.count_nonzero(evidence.fit[place])) for place in evidence.places]
        moves = tuple(
            float(np.linalg.norm(mean[place])) / sqrt(count)
            for place, count in zip(evidence.places, counts, strict=True)
        )
        spreads = tuple(
            float(np.exp(wider[place].sum() / count)) for place, count in zip(evidence.places, counts, strict=True)
        )
        smallest = _smallest(effect, significance)
        rows.append(Signature(effect, _start(effect), moves, spreads, significance, smallest))
        directions.append(direction / significance if significance > 0.0 else direction)
    alike = [
        (a.effect.name, b.effect.name, cosine)
        for (a, x), (b, y) in combinations(zip(rows, directions, strict=True), 2)
        for cosine in (abs(float(x @ y)),)
        if cosine >= ALIKE
    ]
    order = sorted(rows, key=lambda row: -row.significance)
    names = tuple(of.name for of in evidence.observed)
    return Signatures(names, tuple(order), tuple(sorted(alike, key=lambda pair: -pair[2])))


class _Free:
    """The part of a change that the nuisances cannot take up."""

    def __init__(self, evidence: Evidence, nominal: Fit) -> None:
        self._root = np.sqrt(evidence.weight) * evidence.fit
        tangents = np.concatenate([(nominal.slopes * self._root).T, np.eye(nominal.hypothesis.size)])
        self._basis, _ = np.linalg.qr(tangents)
        self._padding = np.zeros(nominal.hypothesis.size)

    def of(self, change: Array) -> Array:
        """Of changes in sigmas (N,), weighted, (N + P,)."""
        padded = np.concatenate([change * self._root, self._padding])
        return padded - self._basis @ (self._basis.T @ padded)


def _start(effect: CandidateEffect) -> str:
    return ", ".join(f"{name} = {number.start:g}" for name, number in effect.kind.parameters().items())


def _smallest(effect: CandidateEffect, significance: float) -> float:
    """By a straight line from nothing to the start value."""
    first = effect.coordinates[0]
    if first.null is None or first.is_ceiling:
        return float("nan")
    if significance < STILL:
        return inf
    away = abs(_value(first, first.start) - _value(first, first.null))
    return away * sqrt(needed(effect)) / significance


def _value(coordinate: Coordinate, x: float) -> float:
    return float(coordinate.value(np.array(x)))

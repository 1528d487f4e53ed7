"""Signatures of the effects in the data: how far each moves each quantity, and which effects look alike.

Every testable effect is switched on at its start value in the nominal robot, and the change of each prediction is
expressed in standard deviations of the noise. The part that the tolerances of the nominal parameters could explain is
projected out, as in the score test. The norm of the rest is the number of standard errors between the effect and no
effect; from it follows, by linear scaling, the smallest size that the data would show. Two effects whose changes then
point in the same direction cannot be distinguished by the data (isolability: Gertler, Fault Detection and Diagnosis in
Engineering Systems, 1998, ch. 4).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import inf, sqrt

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.coordinate import Coordinate
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.naming.verdict import needed_for_name
from symolo.core.arrays import Array

ALIKE = 0.98
"""Cosine from which two changes count as the same."""
STILL = 1e-3
"""Change in sigmas below which a quantity counts as unchanged."""


@dataclass(frozen=True)
class EffectSignature:
    """Changes that one effect makes at its start value."""

    effect: CandidateEffect
    start: str
    """Parameters at their start values, such as `scale = 1.15`."""
    moves: tuple[float, ...]
    """Root mean square change of the mean of each observed quantity [sigma]."""
    spreads: tuple[float, ...]
    """Factor on the standard deviation of each observed quantity; 1 if it does not change."""
    significance: float
    """Standard errors between the start value and no effect, with the nuisances fitted again."""
    smallest: float
    """Change of the first parameter from which the data would name the effect; inf if they never would, NaN if it
    cannot be scaled linearly, as for a limit that does not act."""


@dataclass(frozen=True)
class Signatures:
    """Signatures of all testable effects in one measurement."""

    quantities: tuple[str, ...]
    """Names of the observed quantities, in the order of `EffectSignature.moves`."""
    rows: tuple[EffectSignature, ...]
    """Signatures, the most visible first."""
    alike: tuple[tuple[str, str, float], ...]
    """Names of two effects whose changes point in the same direction, and their cosine."""


def signatures(evidence: Evidence, nominal: HypothesisFit, effects: Sequence[CandidateEffect]) -> Signatures:
    """Return the signatures of effects, in addition to a fit of the nuisances alone.

    Args:
        evidence: The observations.
        nominal: The fit without effects.
        effects: The effects that the data can show.
    """
    base = nominal.hypothesis
    started = (np.array([*base.null(), *(c.start for c in effect.coordinates)]) for effect in effects)
    robots = [base.with_effect(effect).robot(x) for effect, x in zip(effects, started, strict=True)]
    prediction = evidence.predicted([base.robot(base.null()), *robots])
    projection = _NuisanceProjection(evidence, nominal)
    rows, directions = [], []
    for k, effect in enumerate(effects, 1):
        mean = (prediction.mean[k] - prediction.mean[0]) / prediction.sd[0]
        log_spread = np.log(prediction.sd[k] / prediction.sd[0])
        mean, log_spread = (np.where(evidence.fit & np.isfinite(x), x, 0.0) for x in (mean, log_spread))
        direction = np.concatenate([projection.project(mean), sqrt(2.0) * np.sqrt(evidence.weight) * log_spread])
        significance = float(np.linalg.norm(direction))
        counts = [max(1, np.count_nonzero(evidence.fit[place])) for place in evidence.places]
        moves = tuple(
            float(np.linalg.norm(mean[place])) / sqrt(count)
            for place, count in zip(evidence.places, counts, strict=True)
        )
        spreads = tuple(
            float(np.exp(log_spread[place].sum() / count)) for place, count in zip(evidence.places, counts, strict=True)
        )
        smallest = _smallest(effect, significance)
        start = ", ".join(f"{name} = {number.start:g}" for name, number in effect.kind.parameters().items())
        rows.append(EffectSignature(effect, start, moves, spreads, significance, smallest))
        directions.append(direction / significance if significance > 0.0 else direction)
    alike = [
        (a.effect.name, b.effect.name, cosine)
        for (a, x), (b, y) in combinations(zip(rows, directions, strict=True), 2)
        for cosine in (abs(float(x @ y)),)
        if cosine >= ALIKE
    ]
    order = sorted(rows, key=lambda row: -row.significance)
    names = tuple(observed.name for observed in evidence.observed)
    return Signatures(names, tuple(order), tuple(sorted(alike, key=lambda pair: -pair[2])))


class _NuisanceProjection:
    """Projection of a change onto the part that the nuisances cannot explain."""

    def __init__(self, evidence: Evidence, nominal: HypothesisFit) -> None:
        self._root = np.sqrt(evidence.weight) * evidence.fit
        tangents = np.concatenate([(nominal.slopes * self._root).T, np.eye(nominal.hypothesis.size)])
        self._basis, _ = np.linalg.qr(tangents)
        self._padding = np.zeros(nominal.hypothesis.size)

    def project(self, change: Array) -> Array:
        """Return the weighted rest (N + P,) of changes (N,) in sigmas."""
        padded = np.concatenate([change * self._root, self._padding])
        return padded - self._basis @ (self._basis.T @ padded)


def _smallest(effect: CandidateEffect, significance: float) -> float:
    """Return the smallest visible change by linear scaling of the change at the start value."""
    first = effect.coordinates[0]
    if first.null is None or first.is_ceiling:
        return float("nan")
    if significance < STILL:
        return inf
    distance = abs(_value(first, first.start) - _value(first, first.null))
    return distance * sqrt(needed_for_name(effect)) / significance


def _value(coordinate: Coordinate, x: float) -> float:
    return float(coordinate.value(np.array(x)))

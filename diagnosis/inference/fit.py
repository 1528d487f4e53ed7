"""Maximum a posteriori fits of many hypotheses side by side, by damped scoring.

Each step solves the normal equations of the robust weights (iteratively reweighted Gauss-Newton; of noise effects the
Fisher information of log sd) under several dampings, predicts them all at once and takes the best: a batch of
predictions costs little more than one. Bounds hold by projection, and a coordinate that a bound holds is left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import log

import numpy as np

from diagnosis.inference.coordinate import STEP
from diagnosis.inference.evidence import Evidence, Prediction
from diagnosis.inference.hypothesis import Effect, Hypothesis
from diagnosis.inference.likelihood import SPREAD, cost, residuals, robust_weight
from diagnosis.measured.channel import Array

DAMPINGS = ((0.0, 1.0), (0.0, 0.4), (0.0, 0.1), (0.03, 1.0), (1.0, 1.0))
"""Of the diagonal, and the share of the step that is taken: the full step, parts of it for bent valleys, and steps
nearer to steepest descent."""
SETTLED = 0.02
"""Change of the cost at which a fit ends; chances of a name change at some units."""
STEPS = 15
FAR = 40.0
"""Cost above the best of the fits side by side, from which one is given up that would not get there at its pace: no
rival at that distance, its exact cost tells nobody anything."""
STRETCHES = (0.4, 0.7, 0.85, 1.2, 1.4, 2.2)
"""Times as large, that an effect is tried where no step helps any more."""
NUISANCE_STEP = 0.05
"""Of a derivative, in standard deviations of the tolerance."""


@dataclass(frozen=True)
class Fit:
    hypothesis: Hypothesis
    x: Array
    """(P,), coordinates."""
    cost: float
    """Over the rows of the fit, priors included."""
    z: Array
    """(N,), standardised residuals at x, held-out rows too."""
    sd: Array
    """(N,), of the noise at x."""
    slopes: Array
    """(P, N), change of the mean in sigmas for each coordinate."""
    spreads: Array
    """(P, N), change of log sd."""
    information: Array
    """(P, P), of the coordinates, priors included, of the rows of the fit."""
    shared: Array | None = None
    """(P, P), covariance of the coordinates by errors that samples have in common, which the information leaves out."""

    @property
    def prior_cost(self) -> float:
        return float((self.hypothesis.prior(self.x) ** 2).sum())

    def tangents(self, root: Array) -> Array:
        """(N + P, P): directions of all that is fitted, by samples weighted with `root` (N,), then rows of priors."""
        nuisances = len(self.hypothesis.nuisances)
        return np.concatenate([(self.slopes * root).T, np.diag(np.arange(len(self.x)) < nuisances).astype(float)])

    def left(self, z: Array, root: Array) -> Array:
        """(N + P,): residuals z (N,) so weighted, then those of the priors."""
        of_prior = np.zeros(len(self.x))
        of_prior[: len(self.hypothesis.nuisances)] = -self.hypothesis.prior(self.x)
        return np.concatenate([root * z, of_prior])

    @cached_property
    def covariance(self) -> Array:
        """(P, P), of the coordinates; infinite along what the data do not hold."""
        found = np.linalg.pinv(self.information, rcond=1e-12, hermitian=True)
        found = found if self.shared is None else found + self.shared
        found[np.diag_indices_from(found)] = np.where(np.diag(self.information) > 0.0, np.diag(found), np.inf)
        return found

    def std(self, effect: Effect) -> dict[str, float]:
        """Standard errors of an effect's numbers, in their units."""
        places = self.hypothesis.parameters(effect)
        errors = np.sqrt(np.diag(self.covariance)[places]).tolist()
        at = self.x[places].tolist()
        return {c.name: abs(c.slope(x)) * e for c, x, e in zip(effect.coordinates, at, errors, strict=True)}


@dataclass
class _State:
    hypothesis: Hypothesis
    x: Array
    cost: float
    is_settled: bool = False


def fits(evidence: Evidence, starts: Sequence[tuple[Hypothesis, Array]]) -> list[Fit]:
    """The best fit from each start: a hypothesis and its coordinates, (P,)."""
    states = [_State(hypothesis, hypothesis.clipped(x), np.inf) for hypothesis, x in starts]
    found: list[Fit | None] = [None] * len(states)
    for _ in range(STEPS):
        active = [k for k, state in enumerate(states) if not state.is_settled]
        if not active:
            break
        for k, fit in zip(active, _linearised(evidence, [states[k] for k in active]), strict=True):
            found[k] = fit
            states[k].cost = fit.cost
        steps = [_steps(evidence, found[k]) for k in active]  # pyright: ignore[reportArgumentType]
        falls = _moved(evidence, [states[k] for k in active], steps)
        # The cost of play and of limits ripples, and slopes lead into the nearest trough.
        resting = [k for k, fall in zip(active, falls, strict=True) if fall <= SETTLED]
        stretched = [_stretched(states[k].hypothesis, states[k].x) for k in resting]
        further = dict(zip(resting, _moved(evidence, [states[k] for k in resting], stretched), strict=True))
        least = min(state.cost for state in states)
        for k, fall in zip(active, falls, strict=True):
            whole, behind = max(fall, 0.0) + further.get(k, 0.0), states[k].cost - least
            if not whole > SETTLED or (behind > FAR and whole < behind / STEPS):
                states[k].is_settled = True
    moved = [k for k, state in enumerate(states) if found[k] is None or not np.array_equal(found[k].x, state.x)]  # pyright: ignore[reportOptionalMemberAccess]
    for k, fit in zip(moved, _linearised(evidence, [states[k] for k in moved]), strict=True):
        found[k] = fit
    return [fit for fit in found if fit is not None]


def at(evidence: Evidence, hypothesis: Hypothesis, x: Array) -> Fit:
    """A hypothesis at given coordinates (P,), wherever the best are."""
    (found,) = _linearised(evidence, [_State(hypothesis, x, np.inf)])
    return found


def _moved(evidence: Evidence, states: Sequence[_State], trials: Sequence[Array]) -> list[float]:
    """Falls of the cost by the best of the coordinates (M, P) that each is to try, and takes if the cost does fall."""
    if not states:
        return []
    falls = []
    for state, tried, of in zip(
        states, trials, _costs(evidence, [(s.hypothesis, x) for s, x in zip(states, trials, strict=True)]), strict=True
    ):
        best = int(np.argmin(of)) if len(of) else -1
        fall = state.cost - float(of[best]) if len(of) else 0.0
        if fall > 0.0:
            state.x, state.cost = tried[best], float(of[best])
        falls.append(fall)
    return falls


def _stretched(hypothesis: Hypothesis, x: Array) -> Array:
    """(M, P), each effect so many times as large, all else as it is."""
    found = []
    for effect in hypothesis.effects:
        places = hypothesis.parameters(effect)
        for factor in STRETCHES:
            tried = x.copy()
            for place, c in zip(range(places.start, places.stop), effect.coordinates, strict=True):
                if c.is_ceiling:
                    tried[place] += log(factor)
                elif c.null is not None:
                    tried[place] = c.null + factor * (x[place] - c.null)
            found.append(tried)
    return hypothesis.clipped(np.array(found).reshape(len(found), len(x)))


def _linearised(evidence: Evidence, states: Sequence[_State]) -> list[Fit]:
    """Residuals and derivatives of each at its coordinates."""
    if not states:
        return []
    robots, sizes = [], []
    for state in states:
        around = np.concatenate([state.x[None], state.x + np.diag(_offsets(state.hypothesis, state.x))])
        robots += state.hypothesis.robots(around)
        sizes.append(len(around))
    prediction = evidence.of(robots)
    found, first = [], 0
    for state, size in zip(states, sizes, strict=True):
        of = Prediction(prediction.mean[first : first + size], prediction.sd[first : first + size])
        found.append(_fit(evidence, state, of))
        first += size
    return found


def _offsets(hypothesis: Hypothesis, x: Array) -> Array:
    """(P,), steps of the derivatives, back where a bound is near."""
    nuisances = len(hypothesis.nuisances)
    steps = np.full(len(x), STEP)
    steps[:nuisances] = NUISANCE_STEP
    high = np.array([c.high for c in hypothesis.coordinates])
    return np.where(x + steps > high, -steps, steps)


def _fit(evidence: Evidence, state: _State, prediction: Prediction) -> Fit:
    hypothesis, x = state.hypothesis, state.x
    offsets = _offsets(hypothesis, x)[:, None]
    z = residuals(evidence, Prediction(prediction.mean[:1], prediction.sd[:1]))[0]
    slopes = (prediction.mean[1:] - prediction.mean[0]) / (prediction.sd[0] * offsets)
    spreads = np.log(prediction.sd[1:] / prediction.sd[0]) / offsets
    slopes, spreads = (np.where(np.isfinite(of), of, 0.0) for of in (slopes, spreads))
    rows = evidence.fit
    weight = evidence.weight[rows]
    of_mean = slopes[:, rows] * (weight * robust_weight(z[rows]))
    information = of_mean @ slopes[:, rows].T + 2.0 * SPREAD * (spreads[:, rows] * weight) @ spreads[:, rows].T
    nuisances = len(hypothesis.nuisances)
    information[range(nuisances), range(nuisances)] += 1.0
    at = Prediction(prediction.mean[:1], prediction.sd[:1])
    whole = float(cost(evidence, at, hypothesis.prior(x)[None], rows)[0])
    return Fit(hypothesis, x.copy(), whole, z, prediction.sd[0], slopes, spreads, information)


def _steps(evidence: Evidence, fit: Fit) -> Array:
    """(len(DAMPINGS), P), coordinates to try next."""
    rows, hypothesis, x = evidence.fit, fit.hypothesis, fit.x
    z, weight = fit.z[rows], evidence.weight[rows]
    pull = robust_weight(z) * z
    downhill = fit.slopes[:, rows] @ (weight * pull) + fit.spreads[:, rows] @ (weight * (pull * z - SPREAD))
    nuisances = len(hypothesis.nuisances)
    downhill[:nuisances] -= hypothesis.prior(x)
    low = np.array([c.low for c in hypothesis.coordinates])
    high = np.array([c.high for c in hypothesis.coordinates])
    free = ~(((x <= low) & (downhill < 0.0)) | ((x >= high) & (downhill > 0.0)))
    diagonal = np.diag(fit.information)
    free &= diagonal > 0.0
    tried = np.repeat(x[None], len(DAMPINGS), axis=0)
    inside = np.ix_(free, free)
    for k, (damping, share) in enumerate(DAMPINGS):
        damped = fit.information[inside] + np.diag((damping + 1e-9) * diagonal[free])
        tried[k, free] += share * np.linalg.solve(damped, downhill[free])
    return hypothesis.clipped(tried)


def _costs(evidence: Evidence, trials: Sequence[tuple[Hypothesis, Array]]) -> list[Array]:
    """Of each hypothesis at several coordinates (M, P)."""
    robots = [robot for hypothesis, x in trials for robot in hypothesis.robots(x)]
    prediction = evidence.of(robots)
    found, first = [], 0
    for hypothesis, x in trials:
        of = Prediction(prediction.mean[first : first + len(x)], prediction.sd[first : first + len(x)])
        found.append(cost(evidence, of, hypothesis.prior(x), evidence.fit))
        first += len(x)
    return found

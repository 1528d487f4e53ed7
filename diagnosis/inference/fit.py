"""Maximum a posteriori fits of many hypotheses side by side, by damped scoring.

Each step solves the normal equations of the robust weights (iteratively reweighted Gauss-Newton; of noise effects the
Fisher information of log sd) under several dampings, predicts them all at once and takes the best: a batch of
predictions costs little more than one. So the slopes where the full step leads are predicted along with it, for mostly
it is taken. Bounds hold by projection, and a coordinate that a bound holds is left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import log

import numpy as np

from diagnosis.inference.coordinate import STEP
from diagnosis.inference.evidence.evidence import Evidence, Prediction
from diagnosis.inference.hypothesis import CandidateEffect, Hypothesis
from diagnosis.inference.likelihood import SPREAD, cost, residuals, robust_weight
from symolo.core.arrays import Array

DAMPINGS = ((0.0, 1.0), (0.0, 0.4), (0.0, 0.1), (0.03, 1.0), (1.0, 1.0))
"""Of the diagonal, and the share of the step that is taken: the full step first, parts of it for bent valleys, and
steps nearer to steepest descent."""
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


@dataclass(frozen=True, eq=False)
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

    def std(self, effect: CandidateEffect) -> dict[str, float]:
        """Standard errors of an effect's numbers, in their units."""
        places = self.hypothesis.parameters(effect)
        errors = np.sqrt(np.diag(self.covariance)[places]).tolist()
        at = self.x[places].tolist()
        return {c.name: abs(c.slope(x)) * e for c, x, e in zip(effect.coordinates, at, errors, strict=True)}


@dataclass(eq=False)
class _State:
    """A fit under way."""

    hypothesis: Hypothesis
    x: Array
    cost: float = np.inf
    fit: Fit | None = None
    """At x, once its slopes are known."""

    @property
    def around(self) -> tuple[Hypothesis, Array]:
        """What is to be predicted for the slopes at x: there, and beside it along each coordinate."""
        return self.hypothesis, _around(self.hypothesis, self.x)


def fits(evidence: Evidence, starts: Sequence[tuple[Hypothesis, Array]], goal: float = np.inf) -> list[Fit]:
    """The best fit from each start: a hypothesis and its coordinates, (P,).

    Args:
        evidence: What was observed.
        starts: Of fits side by side.
        goal: Cost from which down a fit matters; one that would not get there at its pace is given up.
    """
    states = [_State(hypothesis, hypothesis.clipped(x)) for hypothesis, x in starts]
    active = states
    for _ in range(STEPS):
        if not active:
            break
        known = _linearised(evidence, active)
        falls = _stepped(evidence, active, known)
        # The cost of play and of limits ripples, and slopes lead into the nearest trough.
        further = _stretched(evidence, active, [fall <= SETTLED for fall in falls])
        least = min(state.cost for state in states)
        wholes = [max(fall, 0.0) + more for fall, more in zip(falls, further, strict=True)]
        active = [
            state
            for state, fall in zip(active, wholes, strict=True)
            if _goes_on(fall, state.cost - least, FAR) and _goes_on(fall, state.cost - goal, 0.0)
        ]
    return _linearised(evidence, states)


def _goes_on(fall: float, behind: float, far: float) -> bool:
    """Whether a fit is worth another step after a fall of its cost, that much behind what it should reach."""
    return fall > SETTLED and not (behind > far and fall < behind / STEPS)


def at(evidence: Evidence, hypothesis: Hypothesis, x: Array) -> Fit:
    """A hypothesis at given coordinates (P,), wherever the best are."""
    (found,) = _linearised(evidence, [_State(hypothesis, x)])
    return found


def _linearised(evidence: Evidence, states: Sequence[_State]) -> list[Fit]:
    """Residuals and derivatives of each at its coordinates, predicted where they are not known yet."""
    unknown = [state for state in states if state.fit is None]
    for state, prediction in zip(unknown, _predicted(evidence, [state.around for state in unknown]), strict=True):
        state.fit = _fit(evidence, state.hypothesis, state.x, prediction)
        state.cost = state.fit.cost
    return [state.fit for state in states if state.fit is not None]


def _stepped(evidence: Evidence, states: Sequence[_State], known: Sequence[Fit]) -> list[float]:
    """Falls of the cost by the best step of each, which it takes if the cost does fall."""
    trials = [_steps(evidence, fit) for fit in known]
    asked = [
        (state.hypothesis, np.concatenate([tried, _around(state.hypothesis, tried[0])[1:]]))
        for state, tried in zip(states, trials, strict=True)
    ]
    falls = []
    for state, tried, prediction in zip(states, trials, _predicted(evidence, asked), strict=True):
        best, fall = _tried(evidence, state, tried, prediction.some(slice(len(tried))))
        if fall > 0.0 and best == 0:
            beside = prediction.some([0, *range(len(tried), len(prediction.mean))])
            state.fit = _fit(evidence, state.hypothesis, state.x, beside)
        falls.append(fall)
    return falls


def _stretched(evidence: Evidence, states: Sequence[_State], rests: Sequence[bool]) -> list[float]:
    """Falls of the cost where resting fits try their effects larger and smaller; others learn their slopes."""
    asked = [
        (state.hypothesis, _stretches(state.hypothesis, state.x)) if rest else state.around
        for state, rest in zip(states, rests, strict=True)
        if rest or state.fit is None
    ]
    predictions = iter(_predicted(evidence, asked))
    falls = []
    for state, rest in zip(states, rests, strict=True):
        fall = 0.0
        if rest:
            fall = _tried(evidence, state, _stretches(state.hypothesis, state.x), next(predictions))[1]
        elif state.fit is None:
            state.fit = _fit(evidence, state.hypothesis, state.x, next(predictions))
        falls.append(fall)
    return falls


def _tried(evidence: Evidence, state: _State, tried: Array, prediction: Prediction) -> tuple[int, float]:
    """Which of the coordinates (M, P) is the best, and the fall of the cost by it, which is taken if it does fall."""
    if not len(tried):
        return -1, 0.0
    costs = cost(evidence, prediction, state.hypothesis.prior(tried), evidence.fit)
    best = int(np.argmin(costs))
    fall = state.cost - float(costs[best])
    if fall > 0.0:
        state.x, state.cost, state.fit = tried[best], float(costs[best]), None
    return best, fall


def _stretches(hypothesis: Hypothesis, x: Array) -> Array:
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


def _around(hypothesis: Hypothesis, x: Array) -> Array:
    """(1 + P, P), coordinates, and those a little further along each axis."""
    return np.concatenate([x[None], x + np.diag(_offsets(hypothesis, x))])


def _offsets(hypothesis: Hypothesis, x: Array) -> Array:
    """(P,), steps of the derivatives, back where a bound is near."""
    nuisances = len(hypothesis.nuisances)
    steps = np.full(len(x), STEP)
    steps[:nuisances] = NUISANCE_STEP
    high = np.array([c.high for c in hypothesis.coordinates])
    return np.where(x + steps > high, -steps, steps)


def _fit(evidence: Evidence, hypothesis: Hypothesis, x: Array, prediction: Prediction) -> Fit:
    """At coordinates (P,), from the predictions around them."""
    offsets = _offsets(hypothesis, x)[:, None]
    here = prediction.some(slice(1))
    z = residuals(evidence, here)[0]
    slopes = (prediction.mean[1:] - prediction.mean[0]) / (prediction.sd[0] * offsets)
    spreads = np.log(prediction.sd[1:] / prediction.sd[0]) / offsets
    slopes, spreads = (np.where(np.isfinite(of), of, 0.0) for of in (slopes, spreads))
    rows = evidence.fit
    weight = evidence.weight[rows]
    of_mean = slopes[:, rows] * (weight * robust_weight(z[rows]))
    information = of_mean @ slopes[:, rows].T + 2.0 * SPREAD * (spreads[:, rows] * weight) @ spreads[:, rows].T
    nuisances = len(hypothesis.nuisances)
    information[range(nuisances), range(nuisances)] += 1.0
    whole = float(cost(evidence, here, hypothesis.prior(x)[None], rows)[0])
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


def _predicted(evidence: Evidence, asked: Sequence[tuple[Hypothesis, Array]]) -> list[Prediction]:
    """Of each hypothesis at several coordinates (M, P), all in one go."""
    if not asked:
        return []
    whole = evidence.of([robot for hypothesis, x in asked for robot in hypothesis.robots(x)])
    ends = np.cumsum([len(x) for _, x in asked]).tolist()
    return [whole.some(slice(end - len(x), end)) for (_, x), end in zip(asked, ends, strict=True)]

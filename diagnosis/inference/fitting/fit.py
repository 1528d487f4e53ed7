"""Maximum a posteriori fits of many hypotheses side by side, by damped scoring.

Each step solves the normal equations with robust weights (iteratively reweighted Gauss-Newton; for noise effects with
the Fisher information of log sd) under several dampings, predicts all results at once and takes the best, since a batch
of predictions costs little more than one. The slopes at the end of the full step are predicted in the same batch,
because that step is usually taken. Coordinates are clipped to their bounds, and one that a bound holds is left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import repeat

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.inference.evidence.evidence import Evidence, Prediction
from diagnosis.inference.fitting.coordinate import STEP
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis
from diagnosis.inference.fitting.likelihood import (
    NoiseFit,
    cost,
    costs_of_residuals,
    fitted_noise,
    residuals,
    robust_weight,
    stated_noise,
    weights,
)
from diagnosis.inference.fitting.noise_effects import (
    costs_with_fitted_noise,
    fixed_levels,
    has_noise_effect,
    information_of_levels,
)
from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array

DAMPINGS = ((0.0, 1.0), (0.0, 0.4), (0.0, 0.1), (0.03, 1.0), (1.0, 1.0))
"""Damping of the diagonal, and share of the step: the full step first, parts of it for bent valleys, and steps nearer
to steepest descent."""
SETTLED = 0.02
"""Change of the cost at which a fit ends; far below the changes that affect the choice of effects."""
MAX_STEPS = 15
FAR = 40.0
"""Cost above the best simultaneous fit from which a slow fit is stopped: it is no rival, so its exact cost is not
needed."""
STRETCHES = (0.4, 0.7, 0.85, 1.2, 1.4, 2.2)
"""Factors on the size of an effect that are tried where no step lowers the cost any more."""
NUISANCE_STEP = 0.05
"""Step of a derivative by a nuisance, in standard deviations of its tolerance."""


@dataclass(frozen=True, eq=False)
class HypothesisFit:
    """A hypothesis with its coordinates, and all that the tests of the residuals need."""

    evidence: Evidence
    hypothesis: Hypothesis
    x: Array
    """(P,), coordinates."""
    cost: float
    """Cost over the rows of the fit, priors included."""
    z: Array
    """(N,), standardised residuals at x, including held-out rows; 0 where `lost`."""
    lost: Mask
    """(N,), usable samples without a finite prediction, which make the cost infinite."""
    sd: Array
    """(N,), standard deviation of the fitted noise of a good reading at x."""
    noise: NoiseFit
    """Levels, which are part of `sd`, and shares of outliers."""
    slopes: Array
    """(P, N), derivatives of the mean by the coordinates, in sigmas."""
    spreads: Array
    """(P, N), derivatives of log sd by the coordinates."""
    information: Array
    """(P, P), information about the coordinates from the rows of the fit and the priors."""
    by_tolerances: float = 0.0
    """Part of the cost by numbers which leave their tolerances and are no coordinates (`Predicted`)."""
    shared: Array | None = None
    """(P, P), covariance of the coordinates by errors that samples share, which the information does not include."""
    is_of_whole_runs: bool = False
    """Whether coordinates and information come from whole runs and not from the samples."""

    @property
    def robot(self) -> RobotConfig:
        """Return the fitted robot."""
        return self.hypothesis.robot(self.x)

    @property
    def local_change(self) -> Array | float:
        """Return the change (N,) of the readings by all that is no property of the robot."""
        return self.hypothesis.local_change(self.x)

    @property
    def whitened_change(self) -> Array | float:
        """Return the same change of the samples."""
        return self.evidence.whitened(self.local_change)

    @property
    def prior_cost(self) -> float:
        """Part of the cost that comes from numbers which leave their tolerances."""
        return float((self.hypothesis.prior(self.x) ** 2).sum()) + self.by_tolerances

    @property
    def costs(self) -> Array:
        """Return the cost of each sample, (N,), including held-out rows."""
        return costs_of_residuals(self.evidence, np.where(self.lost, np.inf, self.z), self.sd, self.noise)

    @property
    def whole_cost(self) -> float:
        """Cost over the rows of the fit and the held-out rows, which are independent, with all priors."""
        return self.cost + float(self.costs[self.evidence.heldout].sum())

    def root_weights(self, z: Array | None = None) -> Array:
        """Return the roots of the weights (N,) of samples in a linear test; 0 outside the rows of the fit.

        Args:
            z: (N,), residuals in sigmas; those of the fit by default.
        """
        weight = robust_weight(self.z if z is None else z)
        return np.where(self.evidence.fit, np.sqrt(self.evidence.weight * weight), 0.0)

    def tangents(self, root: Array) -> Array:
        """Return the tangents of all coordinates (N + P, P): samples weighted with `root` (N,), then the priors."""
        nuisances = len(self.hypothesis.nuisances)
        return np.concatenate([(self.slopes * root).T, np.diag(np.arange(len(self.x)) < nuisances).astype(float)])

    def weighted_residuals(self, z: Array, root: Array) -> Array:
        """Return the residuals z (N,) with the same weights, followed by those of the priors, (N + P,)."""
        priors = np.zeros(len(self.x))
        priors[: len(self.hypothesis.nuisances)] = -self.hypothesis.prior(self.x)
        return np.concatenate([root * z, priors])

    @cached_property
    def covariance(self) -> Array:
        """(P, P), covariance of the coordinates; infinite variances where the data do not determine them."""
        covariance = np.linalg.pinv(self.information, rcond=1e-12, hermitian=True)
        if self.shared is not None:
            covariance += self.shared
        np.fill_diagonal(covariance, np.where(np.diag(self.information) > 0.0, np.diag(covariance), np.inf))
        return covariance

    def std(self, effect: CandidateEffect) -> dict[str, float]:
        """Return the standard errors of an effect's parameters, in their units."""
        return self.hypothesis.std(effect, self.x, self.covariance)


@dataclass(frozen=True, eq=False)
class Contest:
    """Hypotheses that are fitted to the same rows and compete with each other."""

    evidence: Evidence
    starts: Sequence[tuple[Hypothesis, Array]]
    """Starts of the fits, each a hypothesis and its coordinates (P,)."""
    goal: float = np.inf
    """Cost that a fit must reach to matter; a fit that is too slow to reach it is stopped."""
    noises: Sequence[NoiseFit] | None = None
    """Noise for each start, if it is known; otherwise each fit finds its own."""


@dataclass(eq=False)
class _State:
    """A fit in progress."""

    contest: Contest
    hypothesis: Hypothesis
    x: Array
    noise: NoiseFit | None = None
    """Noise of the last fit, or that which is known; None before the first one."""
    is_level_fixed: Mask | None = None
    """(Q,), quantities whose noise an effect scales as a whole; None where no effect of the noise is fitted with it."""
    cost: float = np.inf
    fit: HypothesisFit | None = None
    """The fit at x; None until its slopes are known."""
    steps: int = 0
    """Number of steps, with the stretches after them, that were done."""
    fall: float = np.inf
    """Fall of the cost by the last step."""
    is_settled: bool = False
    """Whether no step lowers the cost any more, and the effects are not stretched yet."""


def fits(
    evidence: Evidence,
    starts: Sequence[tuple[Hypothesis, Array]],
    goal: float = np.inf,
    noises: Sequence[NoiseFit] | None = None,
) -> list[HypothesisFit]:
    """Return the best fit from each start; the arguments are those of `Contest`."""
    return fits_of_contests([Contest(evidence, starts, goal, noises)])[0]


def fits_of_contests(contests: Sequence[Contest]) -> list[list[HypothesisFit]]:
    """Return the best fit from each start of each contest; the contests share the stages, but not the rows.

    The results are those of one contest after the other. The batches of predictions are common to all contests, because
    a simulation takes much longer for many small batches than for a few large ones.
    """
    states = [
        _State(contest, hypothesis, hypothesis.clipped(x), noise)
        for contest in contests
        for (hypothesis, x), noise in zip(contest.starts, contest.noises or repeat(None), strict=False)
    ]
    active = states
    while active:
        names = [" and ".join(e.name for e in state.hypothesis.effects) or "no effect" for state in active]
        active[0].contest.evidence.on_fits(names, len(states))
        requests = [(state.hypothesis, _requested(state)) for state in active]
        predictions = _predicted(active, requests)
        ended = [_advance(s, x, p) for s, (_, x), p in zip(active, requests, predictions, strict=True)]
        best_costs = {each: min([s.cost for s in states if s.contest is each], default=0.0) for each in contests}
        active = [s for s, end in zip(active, ended, strict=True) if not end or _goes_on(s, best_costs[s.contest])]
    _linearised(states)
    return [[state.fit for state in states if state.contest is each and state.fit is not None] for each in contests]


def _requested(state: _State) -> Array:
    """Return the coordinates (M, P) whose predictions a fit needs next: of stretches, around x, or of steps."""
    if state.is_settled:
        return _stretches(state.hypothesis, state.x)
    if state.fit is None:
        return _around(state.hypothesis, state.x)
    tried = _steps(state.fit)
    return np.concatenate([tried, _around(state.hypothesis, tried[0])[1:]])


def _advance(state: _State, tried: Array, prediction: Prediction) -> bool:
    """Go on with a fit from the predictions that it requested; return whether a step has ended.

    The best of several steps is taken if the cost falls. Where none lowers it, the effects are stretched: gear play and
    limits make the cost ripple, and slopes lead only into the nearest minimum.
    """
    if state.is_settled:
        state.fall += _take_best(state, tried, prediction)[1]
        state.is_settled = False
    elif state.fit is None:
        _fit(state, prediction)
        return False
    else:
        before, steps = state.cost, len(DAMPINGS)
        best, fall = _take_best(state, tried[:steps], prediction.some(slice(steps)))
        if fall > 0.0 and best == 0:
            _fit(state, prediction.some([0, *range(steps, len(prediction.mean))]))
        state.fall = max(before - state.cost, 0.0)
        state.is_settled = state.fall <= SETTLED
    state.steps += not state.is_settled
    return not state.is_settled


def _goes_on(state: _State, best_cost: float) -> bool:
    """Return whether a fit gets another step; `best_cost` is that of its contest."""
    behind, from_goal = state.cost - best_cost, state.cost - state.contest.goal
    return state.steps < MAX_STEPS and _continues(state.fall, behind, FAR) and _continues(state.fall, from_goal, 0.0)


def _continues(fall: float, behind: float, far: float) -> bool:
    """Return whether a fit gets another step after a fall of its cost, if it is `behind` the cost to reach."""
    return fall > SETTLED and not (behind > far and fall < behind / MAX_STEPS)


def at(evidence: Evidence, hypothesis: Hypothesis, x: Array) -> HypothesisFit:
    """Return a hypothesis at given coordinates (P,), without fitting them."""
    (fit,) = _linearised([_State(Contest(evidence, ()), hypothesis, x)])
    return fit


def _linearised(states: Sequence[_State]) -> list[HypothesisFit]:
    """Return residuals and derivatives of each state at its coordinates; they are predicted if not known yet."""
    unknown = [state for state in states if state.fit is None]
    requests = [(state.hypothesis, _around(state.hypothesis, state.x)) for state in unknown]
    for state, prediction in zip(unknown, _predicted(unknown, requests), strict=True):
        _fit(state, prediction)
    return [state.fit for state in states if state.fit is not None]


def _take_best(state: _State, tried: Array, prediction: Prediction) -> tuple[int, float]:
    """Take the best of coordinates (M, P) if the cost falls; return its index and the fall of the cost."""
    if not len(tried):
        return -1, 0.0
    evidence = state.contest.evidence
    prior, noise = state.hypothesis.prior(tried), state.noise or stated_noise(evidence)
    if state.is_level_fixed is None:
        costs = cost(evidence, prediction, prior, evidence.fit, noise)
    else:
        costs = costs_with_fitted_noise(evidence, prediction, prior, noise, state.is_level_fixed)
    best = int(np.argmin(costs))
    fall = state.cost - float(costs[best])
    if fall > 0.0:
        state.x, state.cost, state.fit = tried[best], float(costs[best]), None
    return best, fall


def _stretches(hypothesis: Hypothesis, x: Array) -> Array:
    """Return coordinates (M, P) with each effect scaled by STRETCHES and everything else unchanged."""
    stretched = [
        hypothesis.scaled(effect, x, factor, with_limits=True) for effect in hypothesis.effects for factor in STRETCHES
    ]
    return np.array(stretched).reshape(len(stretched), len(x))


def _around(hypothesis: Hypothesis, x: Array) -> Array:
    """Return the coordinates, and those a small step further along each axis, (1 + P, P)."""
    return np.concatenate([x[None], x + np.diag(_offsets(hypothesis, x))])


def _offsets(hypothesis: Hypothesis, x: Array) -> Array:
    """Return the steps (P,) of the derivatives, backwards where an upper bound is near."""
    steps = np.full(len(x), STEP)
    steps[: len(hypothesis.nuisances)] = NUISANCE_STEP
    return np.where(x + steps > hypothesis.bounds[1], -steps, steps)


def _fit(state: _State, prediction: Prediction) -> None:
    """Fit the noise of a state at its coordinates, and the fit with its slopes from the predictions around them."""
    evidence, hypothesis, x = state.contest.evidence, state.hypothesis, state.x
    offsets = _offsets(hypothesis, x)[:, None]
    here = prediction.some(slice(1))
    spreads = np.log(prediction.sd[1:] / prediction.sd[0]) / offsets
    spreads = np.where(np.isfinite(spreads), spreads, 0.0)
    start = stated_noise(evidence)
    z = residuals(evidence, here, start)[0]
    lost = np.isinf(z)
    z, sd = np.where(lost, 0.0, z), np.where(lost, evidence.sd, prediction.sd[0])
    if state.noise is not None and state.contest.noises is not None:
        noise = state.noise
    else:
        is_level_fixed = fixed_levels(evidence, hypothesis, spreads)
        noise = fitted_noise(evidence, z, sd, state.noise or start, is_level_fixed)
        state.is_level_fixed = is_level_fixed if has_noise_effect(hypothesis) else None
    level = noise.levels[evidence.quantity]
    z, sd = z / level, sd * level
    slopes = (prediction.mean[1:] - prediction.mean[0]) / (sd * offsets)
    slopes = np.where(np.isfinite(slopes), slopes, 0.0)
    rows = evidence.fit
    weight, is_good = (evidence.weight[rows] * w[rows] for w in weights(evidence, z, sd, noise))
    # The information of reweighted least squares is positive semidefinite, unlike the second derivatives of the cost. A
    # good reading has an information of 2 about its log sd.
    information = (slopes[:, rows] * weight) @ slopes[:, rows].T + 2.0 * (spreads[:, rows] * is_good) @ spreads[
        :, rows
    ].T
    information -= information_of_levels(evidence, hypothesis, spreads, is_good)
    nuisances = len(hypothesis.nuisances)
    information[range(nuisances), range(nuisances)] += 1.0
    state.cost = float(cost(evidence, here, hypothesis.prior(x)[None], rows, noise)[0])
    state.noise = noise
    by_tolerances = float(prediction.by_tolerances[0])
    state.fit = HypothesisFit(
        evidence, hypothesis, x.copy(), state.cost, z, lost, sd, noise, slopes, spreads, information, by_tolerances
    )


def _steps(fit: HypothesisFit) -> Array:
    """Return the coordinates (len(DAMPINGS), P) to try next."""
    evidence, hypothesis, x = fit.evidence, fit.hypothesis, fit.x
    rows = evidence.fit
    z = fit.z[rows]
    weight, is_good = (evidence.weight[rows] * w[rows] for w in weights(evidence, fit.z, fit.sd, fit.noise))
    # Half the negative gradient of the cost by the mean and by log sd.
    downhill = fit.slopes[:, rows] @ (weight * z) + fit.spreads[:, rows] @ (is_good * (z**2 - 1.0))
    nuisances = len(hypothesis.nuisances)
    downhill[:nuisances] -= hypothesis.prior(x)
    low, high = hypothesis.bounds
    # A coordinate at a bound stays there as long as the cost falls only beyond the bound.
    free = ~(((x <= low) & (downhill < 0.0)) | ((x >= high) & (downhill > 0.0)))
    diagonal = np.diag(fit.information)
    free &= diagonal > 0.0
    tried = np.repeat(x[None], len(DAMPINGS), axis=0)
    inside = np.ix_(free, free)
    for k, (damping, share) in enumerate(DAMPINGS):
        # The tiny damping makes the system solvable where two parameters have the same effect on all data.
        damped = fit.information[inside] + np.diag((damping + 1e-9) * diagonal[free])
        tried[k, free] += share * np.linalg.solve(damped, downhill[free])
    return hypothesis.clipped(tried)


def _predicted(states: Sequence[_State], requests: Sequence[tuple[Hypothesis, Array]]) -> list[Prediction]:
    """Return the predictions of each hypothesis at several coordinates (M, P), computed in one batch."""
    if not requests:
        return []
    robots = [robot for hypothesis, x in requests for robot in hypothesis.robots(x)]
    batch = states[0].contest.evidence.predicted(robots)
    ends = np.cumsum([len(x) for _, x in requests]).tolist()
    parts = [batch.some(slice(end - len(x), end)) for (_, x), end in zip(requests, ends, strict=True)]
    evidence = states[0].contest.evidence
    return [
        part.moved(evidence.whitened(hypothesis.local_change(x)))
        for part, (hypothesis, x) in zip(parts, requests, strict=True)
    ]

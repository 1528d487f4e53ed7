"""Select the parameters of the camera that explain the images: all are fitted within their tolerances, a few freely.

Every parameter has a normal prior of its tolerance, so that a deviation within it is no discovery. Each image has
nuisances, such as the error of its pose, with priors too. A parameter is named if freeing it of its prior lowers the
cost by as much as names an effect of a robot (`diagnosis.inference.selection`).

The search differs from that of `diagnosis.inference`, with which it shares the loss, the thresholds and the confidence,
for three reasons.

- A hundred images have several hundred nuisances. They are eliminated image by image (Schur complement), while
  `inference.fit` would have to predict all images again for each of them.
- The noise of images is not known beforehand: each step of a fit estimates its level and its correlation again, while
  `inference.fit` compares hypotheses under one noise.
- Parameters of a camera replace one another closely, such as a yaw and a principal point, and some explain something
  only together. A forward selection would stop before them. After the elimination the cost is almost a quadratic form,
  so that every set of up to three freed parameters is compared with every other at the price of one small system of
  equations each. Effects of a robot are far from linear: each set would need simulations of its own.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations

import numpy as np

from diagnosis.camera.model import CameraModel, CameraParameter
from diagnosis.inference.fitting.likelihood import CORNER, robust_weight
from diagnosis.inference.selection.refusal import THRESHOLD
from diagnosis.inference.selection.rivals import AS_GOOD, confidence
from diagnosis.inference.selection.stepwise import MAX_EFFECTS
from symolo.core.arrays import Array

LOOSE = 30.0
"""Standard deviation of the prior of a freed parameter, in tolerances; it limits directions that no image shows."""
ROUNDS = 12
STEP = 0.05
"""Step of the differences that give slopes, in tolerances."""
REFITS = 3
"""Largest number of selections, each from the quadratic form around the last fit."""
FEW = 3
"""Largest number of parameters of a model for which every set is fitted."""
SETTLED = 0.01
"""Change of every deviation at which a fit ends, in tolerances."""
MAD_TO_SD = 1.4826
"""Standard deviation of normal noise over its median absolute value."""
MAX_CORRELATION = 0.95
MIN_PAIRS = 20
"""Pairs of neighbours from which their correlation is estimated."""

CostOfSet = Callable[[tuple[int, ...]], float]
"""Function that returns the cost of the best fit with a set of freed parameters, given by their indices."""


@dataclass(frozen=True)
class QuadraticCost:
    """The cost around `at`, cost - 2 g d + d H d with d = x - at, with the nuisances of the images at their best."""

    at: Array
    """(P,), deviations in tolerances."""
    H: Array
    """(P, P), half the second derivatives of the cost."""
    g: Array
    """(P,), minus half the slope of the cost at `at`."""
    cost: float
    """Cost at `at`, without priors of the parameters."""

    def solved(self, prior: Array) -> tuple[Array, float]:
        """Return the best x (P,) with a prior of these weights (P,), and its cost."""
        x = np.linalg.solve(self.H + np.diag(prior), self.H @ self.at + self.g)
        d = x - self.at
        return x, float(self.cost - 2.0 * self.g @ d + d @ self.H @ d + prior @ x**2)


@dataclass(frozen=True)
class CameraFit:
    """A fit of all parameters of a model."""

    freed: tuple[int, ...]
    """Indices of the parameters without a tight prior."""
    x: Array
    """(P,), deviations in tolerances."""
    covariance: Array
    """(P, P), covariance of the deviations."""
    cost: float
    sd: float
    """Standard deviation of the noise, in the samples' unit."""
    independent_share: float
    """Number of independent samples that one sample is worth."""
    quadratic: QuadraticCost

    def cost_of(self, freed: tuple[int, ...]) -> float:
        """Return the cost with another set of freed parameters, by the quadratic form."""
        return self.quadratic.solved(_prior(len(self.x), freed))[1]


@dataclass(frozen=True)
class NamedParameter:
    """A named parameter among those that could replace it."""

    parameter: CameraParameter
    place: int
    """Index of the parameter in its model."""
    rise: float
    """Rise of the cost without the parameter."""
    rivals: tuple[tuple[CameraParameter, float], ...]
    """Other parameters with the rise of the cost that each gives in its place, the closest first."""
    confidence: float

    @property
    def ambiguous_with(self) -> tuple[str, ...]:
        return tuple(parameter.name for parameter, rise in self.rivals if rise < AS_GOOD)


@dataclass(frozen=True)
class CameraSelection:
    """Result of the selection."""

    nominal: CameraFit
    """The fit with all parameters within their tolerances."""
    fit: CameraFit
    """The fit with the named parameters freed."""
    named: tuple[NamedParameter, ...]


def fitted(model: CameraModel, freed: Sequence[int], x: Array, noise: tuple[float, float] | None = None) -> CameraFit:
    """Fit with some parameters freed, beginning at deviations (P,).

    The noise is estimated from the residuals, unless `noise` gives its standard deviation and the independent share.
    """
    prior, frame_slopes = _prior(len(x), freed), model.frame_slopes(x)
    sd, independent_share = noise or (max(_spread(model.residuals(x)[model.fit]), model.min_sd), 1.0)
    for _ in range(ROUNDS):
        before = x
        x, _ = _quadratic(model, x, frame_slopes, sd, independent_share).solved(prior)
        if noise is None:
            rest = without_frame_effects(model, model.residuals(x), frame_slopes, sd, independent_share)
            independent_share = _independent_share(model, rest / sd)
            sd = max(_spread(rest[model.fit]), model.min_sd)
        if np.max(np.abs(x - before)) < SETTLED:
            break
    quadratic = _quadratic(model, x, frame_slopes, sd, independent_share)
    _, cost = quadratic.solved(prior)
    covariance = np.linalg.inv(quadratic.H + np.diag(prior))
    return CameraFit(tuple(freed), x, covariance, cost, sd, independent_share, quadratic)


def select_parameters(model: CameraModel) -> CameraSelection:
    """Select the fewest freed parameters that explain the images."""
    namable = [k for k, parameter in enumerate(model.parameters) if parameter.can_be_named]
    null = np.zeros(len(model.parameters))
    fit = fitted(model, namable, null)
    if len(namable) <= FEW:
        # Models with few parameters, blur and noise, are far from linear. Every set is fitted under the same noise,
        # since costs under different noises cannot be compared.
        noise = (fit.sd, fit.independent_share)
        cost_of: CostOfSet = partial(_refitted_cost, model, noise)
        fit = fitted(model, _best_set(cost_of, namable), null)
    else:
        cost_of = fit.cost_of
        for _ in range(REFITS):
            best = _best_set(cost_of, namable)
            if best == fit.freed:
                break
            # The quadratic form holds where it was taken, so the choice is repeated around the new fit.
            fit = fitted(model, best, fit.x)
            cost_of = fit.cost_of
    named = tuple(_named(cost_of, fit.freed, model.parameters, namable, k) for k in fit.freed)
    return CameraSelection(fitted(model, (), null, (fit.sd, fit.independent_share)), fit, named)


def _refitted_cost(model: CameraModel, noise: tuple[float, float], freed: tuple[int, ...]) -> float:
    return fitted(model, freed, np.zeros(len(model.parameters)), noise).cost


def _best_set(cost_of: CostOfSet, namable: Sequence[int]) -> tuple[int, ...]:
    best: tuple[int, ...] = ()
    cost = cost_of(best)
    for size in range(1, min(MAX_EFFECTS, len(namable)) + 1):
        costs = {freed: cost_of(freed) for freed in combinations(namable, size)}
        freed = min(costs, key=lambda candidate: costs[candidate])
        # Two parameters that explain something only together enter together.
        if cost - costs[freed] >= THRESHOLD * (size - len(best)):
            best, cost = freed, costs[freed]
    return best


def _named(
    cost_of: CostOfSet,
    freed: tuple[int, ...],
    parameters: Sequence[CameraParameter],
    namable: Sequence[int],
    place: int,
) -> NamedParameter:
    """Return one of the freed parameters with its rivals, each of which is freed in its place."""
    others = tuple(k for k in freed if k != place)
    cost = cost_of(freed)
    rise = cost_of(others) - cost
    rivals = [(parameters[k], cost_of((*others, k)) - cost) for k in namable if k not in freed]
    rivals.sort(key=lambda rival: rival[1])
    certainty = confidence((rival_rise for _, rival_rise in rivals), rise - THRESHOLD)
    return NamedParameter(parameters[place], place, rise, tuple(rivals), certainty)


def _prior(count: int, freed: Sequence[int]) -> Array:
    """Return the weights of squared deviations in the cost, (count,)."""
    weights = np.ones(count)
    weights[list(freed)] = 1.0 / LOOSE**2
    return weights


def _quadratic(model: CameraModel, x: Array, frame_slopes: Array, sd: float, independent_share: float) -> QuadraticCost:
    """Return the robust cost around deviations x (P,), with the nuisances of each image eliminated."""
    residuals = model.residuals(x)
    slopes = np.empty((len(residuals), len(x)))
    for k in range(len(x)):
        step = np.zeros(len(x))
        step[k] = STEP
        slopes[:, k] = (model.residuals(x - step) - model.residuals(x + step)) / (2.0 * STEP)
    # Outliers are recognised after the fit of the nuisances; else one wrong pose would look like many wrong edges.
    z = without_frame_effects(model, residuals, frame_slopes, sd, independent_share) / sd
    weight = independent_share * robust_weight(np.where(np.isfinite(z), z, 0.0)) / sd**2
    good = np.isfinite(residuals) & np.isfinite(slopes).all(axis=1) & model.fit
    H, g, cost = np.zeros((len(x), len(x))), np.zeros(len(x)), 0.0
    for frame in np.unique(model.frame[good]):
        here = good & (model.frame == frame)
        A, B, r, w = slopes[here], frame_slopes[here], residuals[here], weight[here]
        # Nuisances of different images share no sample, so each image is a small Schur complement of its own.
        inner = np.linalg.inv(np.eye(B.shape[1]) + (B.T * w) @ B)
        wA, wr = w[:, None] * A, w * r
        H += A.T @ wA - wA.T @ B @ inner @ B.T @ wA
        g += A.T @ wr - wA.T @ B @ inner @ B.T @ wr
        cost += float(r @ wr - (B.T @ wr) @ inner @ (B.T @ wr))
    return QuadraticCost(x, H, g, cost)


def without_frame_effects(
    model: CameraModel, residuals: Array, frame_slopes: Array, sd: float, independent_share: float
) -> Array:
    """Return the residuals (N,) after a robust fit of the nuisances of each image."""
    rest = residuals.copy()
    for frame in np.unique(model.frame):
        here = np.flatnonzero((model.frame == frame) & np.isfinite(residuals))
        B, z = frame_slopes[here], residuals[here]
        r = z
        for _ in range(4):
            w = independent_share * robust_weight(r / sd) / sd**2
            r = z - B @ np.linalg.solve(np.eye(B.shape[1]) + (B.T * w) @ B, B.T @ (w * z))
        rest[here] = r
    return rest


def _spread(residuals: Array) -> float:
    known = residuals[np.isfinite(residuals)]
    return MAD_TO_SD * float(np.median(np.abs(known)))


def _independent_share(model: CameraModel, z: Array) -> float:
    """Return the number of independent samples that one is worth, by AR(1) noise along neighbours in one image."""
    use = np.isfinite(z) & (np.abs(z) < CORNER) & model.fit
    are_neighbours = use[1:] & use[:-1] & (model.frame[1:] == model.frame[:-1])
    a, b = z[:-1][are_neighbours], z[1:][are_neighbours]
    max_share = model.max_independent * len(np.unique(model.frame[use])) / max(1, np.count_nonzero(use))
    if len(a) < MIN_PAIRS:
        return min(1.0, max_share)
    p = float(np.clip((a @ b) / np.sqrt((a @ a) * (b @ b)), 0.0, MAX_CORRELATION))
    # The variance of a mean of many AR(1) samples is (1 + p)/(1 - p) times that of independent ones.
    return min((1.0 - p) / (1.0 + p), max_share)

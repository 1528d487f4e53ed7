"""Select the numbers of the camera that explain the images: all are fitted within their tolerances, a few freely.

Every number has a normal prior of its tolerance, so that a deviation within it is no discovery; each image has
numbers of its own, with priors too, such as the error of its pose. A number is named when freeing it of its prior lets
the cost fall by as much as names an effect of a robot (`diagnosis.inference.selection`). Near the best fit the cost is
a quadratic form once the images' own numbers are eliminated (Schur complement), so that every set of up to three
freed numbers is compared with every other, not only those that a greedy search meets.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Protocol

import numpy as np

from diagnosis.camera.case import Ints, Mask
from diagnosis.camera.parameter import CameraNumber
from diagnosis.inference.likelihood import CORNER, robust_weight
from diagnosis.inference.rivals import AS_GOOD, confidence
from diagnosis.inference.selection import MAX_EFFECTS, THRESHOLD
from symolo.core.arrays import Array

LOOSE = 30.0
"""Standard deviation of the prior of freed numbers, in tolerances; it holds directions that nothing measures."""
ROUNDS = 12
STEP = 0.05
"""Step of the differences that give slopes, in tolerances."""
REFITS = 3
FEW = 3
"""Largest number of parameters of a model of which every set is fitted."""
SETTLED = 0.01
"""Step at which a fit ends, in tolerances."""


class CameraModel(Protocol):
    """What a camera's fit needs: samples, the numbers that explain them, and their residuals."""

    @property
    def numbers(self) -> tuple[CameraNumber, ...]: ...

    @property
    def frame(self) -> Ints:
        """Return the frame of each sample, (N,)."""
        ...

    @property
    def fit(self) -> Mask:
        """Return the samples for selection and fit, (N,)."""
        ...

    @property
    def min_sd(self) -> float:
        """Return the smallest standard deviation of a sample that the fit assumes."""
        ...

    @property
    def max_independent(self) -> float:
        """Return for how many independent samples an image counts at most: images of one floor share its stains."""
        ...

    def residuals(self, x: Array) -> Array:
        """Return measured less predicted values for deviations (P,), (N,)."""
        ...

    def frame_slopes(self, x: Array) -> Array:
        """Return the change of the prediction by a standard deviation of each nuisance of the frame, (N, Q)."""
        ...


@dataclass(frozen=True)
class CameraFit:
    freed: tuple[int, ...]
    """Indices of the numbers without a tight prior."""
    x: Array
    """(P,), in tolerances."""
    covariance: Array
    """(P, P), in tolerances."""
    cost: float
    sd: float
    """Standard deviation of the noise, in the samples' unit."""
    independent_share: float
    """Independent samples for which one sample counts."""
    quadratic: "QuadraticCost"


@dataclass(frozen=True)
class QuadraticCost:
    """The cost around `at`: least - 2 g d + d H d with d = x - at, the nuisances of the frames at their best."""

    at: Array
    H: Array
    g: Array
    least: float

    def solved(self, prior: Array) -> tuple[Array, float]:
        """Return the best x (P,) with a prior of these weights (P,), and its cost."""
        x = np.linalg.solve(self.H + np.diag(prior), self.H @ self.at + self.g)
        d = x - self.at
        return x, float(self.least - 2.0 * self.g @ d + d @ self.H @ d + prior @ x**2)


@dataclass(frozen=True)
class NamedCameraNumber:
    """A named number beside those that could replace it."""

    number: CameraNumber
    place: int
    rise: float
    """Rise of the cost without the number."""
    rivals: tuple[tuple[CameraNumber, float], ...]
    """Other numbers with the rise of the cost that each gives in its place, the closest first."""
    confidence: float

    @property
    def ambiguous_with(self) -> tuple[str, ...]:
        return tuple(number.name for number, worse in self.rivals if worse < AS_GOOD)


@dataclass(frozen=True)
class CameraSelection:
    nominal: CameraFit
    """Fit with all numbers within their tolerances."""
    fit: CameraFit
    choices: tuple[NamedCameraNumber, ...]


def prior(numbers: Sequence[CameraNumber], freed: Sequence[int]) -> Array:
    """Return the weights of squared deviations in the cost, (P,)."""
    weights = np.ones(len(numbers))
    weights[list(freed)] = 1.0 / LOOSE**2
    return weights


def fitted(model: CameraModel, freed: Sequence[int], x: Array, noise: tuple[float, float] | None = None) -> CameraFit:
    """Fit with some numbers freed, from deviations (P,) on.

    The noise is estimated from the residuals, unless `noise` gives its standard deviation and the independent share.
    """
    weights, own = prior(model.numbers, freed), model.frame_slopes(x)
    sd, independent_share = noise or (max(_spread(model.residuals(x)[model.fit]), model.min_sd), 1.0)
    found = quadratic = None
    for _ in range(ROUNDS):
        quadratic = _quadratic(model, x, own, sd, independent_share)
        found, _ = quadratic.solved(weights)
        step = np.max(np.abs(found - x))
        x = found
        if noise is None:
            left = without_frame_effects(model, model.residuals(x), own, sd, independent_share)
            sd, independent_share = max(_spread(left[model.fit]), model.min_sd), _worth(model, left / sd)
        if step < SETTLED:
            break
    quadratic = _quadratic(model, x, own, sd, independent_share)
    _, cost = quadratic.solved(weights)
    covariance = np.linalg.inv(quadratic.H + np.diag(weights))
    return CameraFit(tuple(freed), x, covariance, cost, sd, independent_share, quadratic)


def choose(model: CameraModel) -> CameraSelection:
    """Select the fewest freed numbers that explain the images."""
    namable = [k for k, number in enumerate(model.numbers) if number.can_be_named]
    null = np.zeros(len(model.numbers))
    fit = fitted(model, namable, null)
    if len(namable) <= FEW:
        costs: _Costs = _Refitted(model, (fit.sd, fit.independent_share))
        fit = fitted(model, _best_set(costs, namable), null)
    else:
        costs = _Near(fit, model.numbers)
        for _ in range(REFITS):  # the quadratic form is that of where it was taken
            names = _best_set(costs, namable)
            if names == fit.freed:
                break
            fit = fitted(model, names, fit.x)
            costs = _Near(fit, model.numbers)
    choices = tuple(_choice(costs, fit.freed, model.numbers, namable, k) for k in fit.freed)
    return CameraSelection(fitted(model, (), null, (fit.sd, fit.independent_share)), fit, choices)


class _Costs(Protocol):
    """The cost of the best fit with a set of freed numbers."""

    def of(self, freed: tuple[int, ...]) -> float: ...


@dataclass(frozen=True)
class _Near:
    """Costs by the quadratic form around a fit."""

    fit: CameraFit
    numbers: tuple[CameraNumber, ...]

    def of(self, freed: tuple[int, ...]) -> float:
        return self.fit.quadratic.solved(prior(self.numbers, freed))[1]


@dataclass(frozen=True)
class _Refitted:
    """Costs by one fit for each set, for models of few numbers that are far from linear."""

    model: CameraModel
    noise: tuple[float, float]

    def of(self, freed: tuple[int, ...]) -> float:
        return fitted(self.model, freed, np.zeros(len(self.model.numbers)), self.noise).cost


def _best_set(costs: _Costs, namable: Sequence[int]) -> tuple[int, ...]:
    best: tuple[int, ...] = ()
    cost = costs.of(best)
    for size in range(1, min(MAX_EFFECTS, len(namable)) + 1):
        tried = {freed: costs.of(freed) for freed in combinations(namable, size)}
        freed = min(tried, key=lambda candidate: tried[candidate])
        # Two numbers that explain something only together enter together.
        if cost - tried[freed] >= THRESHOLD * (size - len(best)):
            best, cost = freed, tried[freed]
    return best


def _choice(
    costs: _Costs, freed: tuple[int, ...], numbers: Sequence[CameraNumber], namable: Sequence[int], place: int
) -> NamedCameraNumber:
    others = tuple(k for k in freed if k != place)
    own = costs.of(freed)
    nothing = costs.of(others)
    rivals = [(numbers[k], costs.of((*others, k)) - own) for k in namable if k not in freed]
    rivals.sort(key=lambda of: of[1])
    certainty = confidence((worse for _, worse in rivals), nothing - own - THRESHOLD)
    return NamedCameraNumber(numbers[place], place, nothing - own, tuple(rivals), certainty)


def _quadratic(model: CameraModel, x: Array, own: Array, sd: float, independent_share: float) -> QuadraticCost:
    left = model.residuals(x)
    slopes = np.empty((len(left), len(x)))
    for k in range(len(x)):
        step = np.zeros(len(x))
        step[k] = STEP
        slopes[:, k] = (model.residuals(x - step) - model.residuals(x + step)) / (2.0 * STEP)
    z = without_frame_effects(model, left, own, sd, independent_share) / sd
    weight = independent_share * robust_weight(np.where(np.isfinite(z), z, 0.0)) / sd**2
    good = np.isfinite(left) & np.isfinite(slopes).all(axis=1) & model.fit
    H, g, least = np.zeros((len(x), len(x))), np.zeros(len(x)), 0.0
    for frame in np.unique(model.frame[good]):
        here = good & (model.frame == frame)
        A, B, r, w = slopes[here], own[here], left[here], weight[here]
        inner = np.linalg.inv(np.eye(B.shape[1]) + (B.T * w) @ B)
        wA, wr = w[:, None] * A, w * r
        H += A.T @ wA - wA.T @ B @ inner @ B.T @ wA
        g += A.T @ wr - wA.T @ B @ inner @ B.T @ wr
        least += float(r @ wr - (B.T @ wr) @ inner @ (B.T @ wr))
    return QuadraticCost(x, H, g, least)


def without_frame_effects(model: CameraModel, left: Array, own: Array, sd: float, independent_share: float) -> Array:
    """Return the residuals (N,) after a robust fit of each frame's nuisances."""
    rest = left.copy()
    for frame in np.unique(model.frame):
        here = np.flatnonzero((model.frame == frame) & np.isfinite(left))
        B, z = own[here], left[here]
        r = z
        for _ in range(4):
            w = independent_share * robust_weight(r / sd) / sd**2
            r = z - B @ np.linalg.solve(np.eye(B.shape[1]) + (B.T * w) @ B, B.T @ (w * z))
        rest[here] = r
    return rest


def _spread(left: Array) -> float:
    known = left[np.isfinite(left)]
    return 1.4826 * float(np.median(np.abs(known)))


def _worth(model: CameraModel, z: Array) -> float:
    """Return the independent samples for which one counts, by AR(1) noise along neighbours in one image."""
    use = np.isfinite(z) & (np.abs(z) < CORNER) & model.fit
    next_to = use[1:] & use[:-1] & (model.frame[1:] == model.frame[:-1])
    a, b = z[:-1][next_to], z[1:][next_to]
    most = model.max_independent * len(np.unique(model.frame[use])) / max(1, np.count_nonzero(use))
    if len(a) < 20:
        return min(1.0, most)
    p = float(np.clip((a @ b) / np.sqrt((a @ a) * (b @ b)), 0.0, 0.95))
    return min((1.0 - p) / (1.0 + p), most)

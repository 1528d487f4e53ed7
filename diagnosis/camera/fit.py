"""Which numbers of the camera the pictures ask for: all are fitted within their tolerances, a few of them freely.

Every number has a normal prior of its tolerance, so that a deviation within it is no discovery; each picture has
numbers of its own, with priors too, such as the error of its pose. A number is named when freeing it of its prior lets
the cost fall by as much as names an effect of a robot (`diagnosis.inference.selection`). Near the best fit the cost is
a quadratic form once the pictures' own numbers are eliminated (Schur complement), so that every set of up to three
freed numbers is compared with every other, not only those that a greedy search meets.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import exp
from typing import Protocol

import numpy as np

from diagnosis.camera.case import Ints, Mask
from diagnosis.camera.parameter import Number
from diagnosis.inference.likelihood import CORNER, robust_weight
from diagnosis.inference.rivals import AS_GOOD
from diagnosis.inference.selection import MAX_EFFECTS, THRESHOLD
from symolo.core.arrays import Array

LOOSE = 30.0
"""Tolerances of the prior of what is freed, so that a direction that nothing measures does not run away."""
ROUNDS = 12
STEP = 0.05
"""Of the differences by which slopes are taken, in tolerances."""
REFITS = 3
FEW = 3
"""Numbers of a model, of which every set is fitted."""
SETTLED = 0.01
"""Tolerances, of a step after which nothing moves any more."""


class Model(Protocol):
    """What is measured in pictures and predicted of them."""

    @property
    def numbers(self) -> tuple[Number, ...]: ...

    @property
    def frame(self) -> Ints:
        """(N,), the picture of each sample."""
        ...

    @property
    def fit(self) -> Mask:
        """(N,), samples that may choose and fit."""
        ...

    @property
    def min_sd(self) -> float:
        """Standard deviation of a sample's noise, at least: what no model of it tells."""
        ...

    @property
    def max_worth(self) -> float:
        """Independent samples that one picture is worth at most, for pictures of one floor share its stains."""
        ...

    def left(self, x: Array) -> Array:
        """(N,), measured - predicted with deviations (P,)."""
        ...

    def own(self, x: Array) -> Array:
        """(N, Q), change of the prediction by a standard deviation of each of the picture's own numbers."""
        ...


@dataclass(frozen=True)
class Fit:
    freed: tuple[int, ...]
    """Places in the model's numbers."""
    x: Array
    """(P,), in tolerances."""
    covariance: Array
    """(P, P), in tolerances."""
    cost: float
    sd: float
    """Of the noise, in the samples' unit."""
    worth: float
    """Independent samples that one is worth."""
    quadratic: "Quadratic"


@dataclass(frozen=True)
class Quadratic:
    """The samples' cost around `at`: least - 2 g d + d H d, d = x - at, the pictures' own numbers at their best."""

    at: Array
    H: Array
    g: Array
    least: float

    def solved(self, prior: Array) -> tuple[Array, float]:
        """The best x (P,) with a prior of these weights (P,), and its cost."""
        x = np.linalg.solve(self.H + np.diag(prior), self.H @ self.at + self.g)
        d = x - self.at
        return x, float(self.least - 2.0 * self.g @ d + d @ self.H @ d + prior @ x**2)


@dataclass(frozen=True)
class Choice:
    """A freed number among those that might stand in its place."""

    number: Number
    place: int
    rise: float
    """Of the cost without it."""
    rivals: tuple[tuple[Number, float], ...]
    """With the cost that each has more, the closest first."""
    confidence: float

    @property
    def ambiguous_with(self) -> tuple[str, ...]:
        return tuple(number.name for number, worse in self.rivals if worse < AS_GOOD)


@dataclass(frozen=True)
class Chosen:
    nominal: Fit
    """Within tolerances alone."""
    fit: Fit
    choices: tuple[Choice, ...]


def prior(numbers: Sequence[Number], freed: Sequence[int]) -> Array:
    """(P,), weights of squared deviations."""
    weights = np.ones(len(numbers))
    weights[list(freed)] = 1.0 / LOOSE**2
    return weights


def fitted(model: Model, freed: Sequence[int], x: Array, noise: tuple[float, float] | None = None) -> Fit:
    """With some numbers freed, from deviations (P,) on.

    The noise is that of what the fit leaves; or `noise`, its standard deviation and the worth of a sample.
    """
    weights, own = prior(model.numbers, freed), model.own(x)
    sd, worth = noise or (max(_spread(model.left(x)[model.fit]), model.min_sd), 1.0)
    found = quadratic = None
    for _ in range(ROUNDS):
        quadratic = _quadratic(model, x, own, sd, worth)
        found, _ = quadratic.solved(weights)
        step = np.max(np.abs(found - x))
        x = found
        if noise is None:
            left = without_own(model, model.left(x), own, sd, worth)
            sd, worth = max(_spread(left[model.fit]), model.min_sd), _worth(model, left / sd)
        if step < SETTLED:
            break
    quadratic = _quadratic(model, x, own, sd, worth)
    _, cost = quadratic.solved(weights)
    covariance = np.linalg.inv(quadratic.H + np.diag(weights))
    return Fit(tuple(freed), x, covariance, cost, sd, worth, quadratic)


def choose(model: Model) -> Chosen:
    """The fewest freed numbers that explain the pictures."""
    namable = [k for k, number in enumerate(model.numbers) if number.can_be_named]
    null = np.zeros(len(model.numbers))
    fit = fitted(model, namable, null)
    if len(namable) <= FEW:
        costs: _Costs = _Refitted(model, (fit.sd, fit.worth))
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
    return Chosen(fitted(model, (), null, (fit.sd, fit.worth)), fit, choices)


class _Costs(Protocol):
    """The cost at the best of a set of freed numbers."""

    def of(self, freed: tuple[int, ...]) -> float: ...


@dataclass(frozen=True)
class _Near:
    """By the quadratic form around a fit."""

    fit: Fit
    numbers: tuple[Number, ...]

    def of(self, freed: tuple[int, ...]) -> float:
        return self.fit.quadratic.solved(prior(self.numbers, freed))[1]


@dataclass(frozen=True)
class _Refitted:
    """Each by a fit of its own, for models of few numbers that are far from straight."""

    model: Model
    noise: tuple[float, float]

    def of(self, freed: tuple[int, ...]) -> float:
        return fitted(self.model, freed, np.zeros(len(self.model.numbers)), self.noise).cost


def _best_set(costs: _Costs, namable: Sequence[int]) -> tuple[int, ...]:
    best: tuple[int, ...] = ()
    cost = costs.of(best)
    for size in range(1, min(MAX_EFFECTS, len(namable)) + 1):
        tried = {freed: costs.of(freed) for freed in combinations(namable, size)}
        freed = min(tried, key=lambda of: tried[of])
        # Two that only together explain anything enter together.
        if cost - tried[freed] >= THRESHOLD * (size - len(best)):
            best, cost = freed, tried[freed]
    return best


def _choice(
    costs: _Costs, freed: tuple[int, ...], numbers: Sequence[Number], namable: Sequence[int], place: int
) -> Choice:
    others = tuple(k for k in freed if k != place)
    own = costs.of(freed)
    nothing = costs.of(others)
    rivals = [(numbers[k], costs.of((*others, k)) - own) for k in namable if k not in freed]
    rivals.sort(key=lambda of: of[1])
    weight = sum(exp(-0.5 * max(worse, -50.0)) for _, worse in rivals)
    weight += exp(-0.5 * max(nothing - own - THRESHOLD, 0.0))
    return Choice(numbers[place], place, nothing - own, tuple(rivals), 1.0 / (1.0 + weight))


def _quadratic(model: Model, x: Array, own: Array, sd: float, worth: float) -> Quadratic:
    left = model.left(x)
    slopes = np.empty((len(left), len(x)))
    for k in range(len(x)):
        step = np.zeros(len(x))
        step[k] = STEP
        slopes[:, k] = (model.left(x - step) - model.left(x + step)) / (2.0 * STEP)
    z = without_own(model, left, own, sd, worth) / sd
    weight = worth * robust_weight(np.where(np.isfinite(z), z, 0.0)) / sd**2
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
    return Quadratic(x, H, g, least)


def without_own(model: Model, left: Array, own: Array, sd: float, worth: float) -> Array:
    """What is left, (N,), once each picture's own numbers are fitted, robustly."""
    rest = left.copy()
    for frame in np.unique(model.frame):
        here = np.flatnonzero((model.frame == frame) & np.isfinite(left))
        B, z = own[here], left[here]
        r = z
        for _ in range(4):
            w = worth * robust_weight(r / sd) / sd**2
            r = z - B @ np.linalg.solve(np.eye(B.shape[1]) + (B.T * w) @ B, B.T @ (w * z))
        rest[here] = r
    return rest


def _spread(left: Array) -> float:
    known = left[np.isfinite(left)]
    return 1.4826 * float(np.median(np.abs(known)))


def _worth(model: Model, z: Array) -> float:
    """Independent samples that one is worth, of AR(1) noise along neighbours in one picture."""
    use = np.isfinite(z) & (np.abs(z) < CORNER) & model.fit
    next_to = use[1:] & use[:-1] & (model.frame[1:] == model.frame[:-1])
    a, b = z[:-1][next_to], z[1:][next_to]
    most = model.max_worth * len(np.unique(model.frame[use])) / max(1, np.count_nonzero(use))
    if len(a) < 20:
        return min(1.0, most)
    p = float(np.clip((a @ b) / np.sqrt((a @ a) * (b @ b)), 0.0, 0.95))
    return min((1.0 - p) / (1.0 + p), most)

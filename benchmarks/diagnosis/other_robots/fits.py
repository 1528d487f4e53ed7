"""Least squares over the tolerances of the nominal parameters and the parameters of some effects.

A model is a function `predict(keys, thetas)`. `thetas` has one row per variant: first the deviations of the nominal
parameters in units of their tolerance, then the parameters of each effect. It returns one row of noise-free
measurements per variant.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.diagnosis.other_robots.draws import Array
from benchmarks.diagnosis.other_robots.effects import Key, Table

Predict = Callable[[list[Key], Array], Array]
Whiten = Callable[[Array], Array]
DAMPINGS = (1e-6, 1e-2, 1.0, 30.0)


@dataclass
class Problem:
    """A model, the whitening of its residuals and the effects that it knows."""

    predict: Predict
    whiten: Whiten
    table: Table
    nominal: int
    """Number of nominal parameters with a tolerance."""
    rounds: int = 20
    """Most rounds of a fit."""

    def bounds(self, keys: list[Key]) -> tuple[Array, Array]:
        """Return the lowest and highest values of all columns of theta."""
        low, high = [-8.0] * self.nominal, [8.0] * self.nominal
        for name, _ in keys:
            for p in self.table[name].parameters:
                width = p.high - p.low
                low.append(p.low - 0.5 * width if p.low < 0 else 0.3 * p.low)
                high.append(p.high + 0.5 * width)
        return np.array(low), np.array(high)

    def residuals(self, target: Array, keys: list[Key], thetas: Array) -> Array:
        """Return whitened residuals and, behind them, the deviations in tolerances, a row per variant."""
        white = self.whiten(target[None] - self.predict(keys, thetas))
        return np.concatenate([white, thetas[:, : self.nominal]], axis=1)

    def minimum(self, target: Array, keys: list[Key], start: Array, rounds: int | None = None) -> float:
        """Return the smallest weighted sum of squares near `start` (Levenberg-Marquardt, several dampings at once)."""
        low, high = self.bounds(keys)
        theta = np.clip(np.asarray(start, float), low, high)
        step = np.concatenate([np.full(self.nominal, 0.02), 1e-3 * (high - low)[self.nominal :]])
        cost = np.inf
        for _ in range(rounds or self.rounds):
            signs = np.where(theta + step > high, -1.0, 1.0)
            r = self.residuals(target, keys, np.vstack([theta, theta + np.diag(step * signs)]))
            cost = min(cost, float(r[0] @ r[0]))
            jacobian = ((r[1:] - r[0]) / (step * signs)[:, None]).T
            normal, gradient = jacobian.T @ jacobian, jacobian.T @ r[0]
            diagonal = np.diag(np.diag(normal) + 1e-12)
            moves = [np.linalg.solve(normal + damping * diagonal, gradient) for damping in DAMPINGS]
            trials = np.array([np.clip(theta - move, low, high) for move in moves])
            after = self.residuals(target, keys, trials)
            costs = np.einsum("ij,ij->i", after, after)
            best = int(np.argmin(costs))
            if not costs[best] < cost:
                break
            gain = cost - float(costs[best])
            theta, cost = trials[best], float(costs[best])
            if gain < 0.05 + 1e-4 * cost:
                break
        return cost

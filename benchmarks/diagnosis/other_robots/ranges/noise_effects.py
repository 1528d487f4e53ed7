"""Effects on the noise of a range bench, listed and not listed, and their likelihood ratios."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.diagnosis.other_robots.draws import Array, log_uniform, pick, significant
from benchmarks.diagnosis.other_robots.hidden import MIN_RATIO
from benchmarks.diagnosis.other_robots.range_noise import ROUNDING_M2
from benchmarks.diagnosis.other_robots.ranges.bench import RangeBench

PARAMETERS = {
    "noise_scale": ["scale"],
    "ambient_noise": ["coefficient_per_klux"],
    "range_wander": ["sd_m", "time_constant_s"],
}
ATTEMPTS = 25
JUMP_CHANCE = 0.15
"""Chance per row that a sensor with two states changes its state."""


@dataclass
class NoiseEffect:
    """An effect on the noise with its parameters and likelihood ratio."""

    name: str
    values: list[float]
    ratio: float

    def noise(self, b: RangeBench) -> Array:
        """Return the standard deviation of the white noise in each row."""
        if self.name == "noise_scale":
            return b.noise * self.values[0]
        if self.name == "ambient_noise":
            return b.noise * np.sqrt(1 + self.values[0] * b.lux / 1000)
        return b.noise

    def spread(self, b: RangeBench) -> Array:
        """Return the standard deviation of each reading."""
        sd = np.sqrt(self.noise(b) ** 2 + ROUNDING_M2)
        return np.sqrt(sd**2 + self.values[0] ** 2) if self.name == "range_wander" else sd

    def wander(self, rng: np.random.Generator, b: RangeBench) -> Array | float:
        """Return the wander of the readings, a first-order autoregressive process in time."""
        if self.name != "range_wander":
            return 0.0
        sd, tau = self.values
        walk = np.empty(b.n)
        walk[0] = rng.normal(0, sd)
        for k in range(1, b.n):
            a = np.exp(-(b.t[k] - b.t[k - 1]) / tau)
            walk[k] = a * walk[k - 1] + sd * np.sqrt(1 - a * a) * rng.normal()
        return walk


def _divergence(ratio: Array | float) -> Array | float:
    """Return twice the expected logarithm of the likelihood ratio of one reading whose variance is wrong by a ratio."""
    return ratio - 1 - np.log(ratio)


def _wander_ratios(b: RangeBench, values: list[float], fit: Array) -> tuple[float, float]:
    """Return the likelihood ratios of a wander; with the scale of the noise fixed and free."""
    stated = b.noise[fit] ** 2 + ROUNDING_M2
    n = len(stated)
    lag = np.abs(b.t[fit][:, None] - b.t[fit][None])
    true = values[0] ** 2 * np.exp(-lag / values[1]) + np.diag(stated)
    jacobian = np.column_stack([np.full(n, b.tolerance[0]), b.d[fit] * b.tolerance[1]])

    def apart(scale: float) -> float:
        model = np.diag(stated * scale) + jacobian @ jacobian.T
        both = np.linalg.solve(model, true + jacobian @ jacobian.T)
        return float(np.trace(both) - n - np.linalg.slogdet(both)[1])

    return apart(1.0), min(apart(scale) for scale in np.geomspace(1, 200, 25))


def ratios(b: RangeBench, name: str, values: list[float], fit: Array) -> tuple[float, float]:
    """Return the likelihood ratios of an effect; with the scale of the noise fixed and free."""
    n = int(fit.sum())
    if name == "noise_scale":
        ratio = float(n * _divergence(values[0] ** 2))
        return ratio, ratio
    if name == "ambient_noise":
        v = 1 + values[0] * b.lux[fit] / 1000
        return float(np.sum(_divergence(v))), float(n * np.log(v.mean()) - np.log(v).sum())
    return _wander_ratios(b, values, fit)


def _noise_scale(rng: np.random.Generator, _: RangeBench) -> list[float]:
    """Return a factor of the noise."""
    return [significant(pick(rng, [log_uniform(rng, 1.5, 6), log_uniform(rng, 0.25, 0.65)], [3, 1]))]


def _ambient_noise(rng: np.random.Generator, _: RangeBench) -> list[float]:
    """Return a coefficient of the light."""
    return [significant(log_uniform(rng, 0.05, 8))]


def _range_wander(rng: np.random.Generator, b: RangeBench) -> list[float]:
    """Return standard deviation and time constant of a wander."""
    return [
        significant(float(np.median(b.noise)) * log_uniform(rng, 0.8, 8)),
        significant(log_uniform(rng, 4 * (b.t[1] - b.t[0]), 0.3 * b.last)),
    ]


DRAWS: dict[str, Callable[[np.random.Generator, RangeBench], list[float]]] = {
    "noise_scale": _noise_scale,
    "ambient_noise": _ambient_noise,
    "range_wander": _range_wander,
}


def draw_noise_effect(rng: np.random.Generator, b: RangeBench, fit: Array) -> NoiseEffect | None:
    """Return a visible effect on the noise that the format lists, or None."""
    name = pick(rng, list(DRAWS), [1, 1, 1])
    for _ in range(ATTEMPTS):
        values = DRAWS[name](rng, b)
        fixed, free = ratios(b, name, values, fit)
        if min(fixed, free) >= MIN_RATIO:
            return NoiseEffect(name, values, free)
    return None


def dark_noise(rng: np.random.Generator, b: RangeBench, fit: Array) -> tuple[Array, float]:
    """Return factors of the noise that is larger on dark targets, and the likelihood ratio beside any noise_scale."""
    variance = (0.6 / b.rho) ** rng.uniform(1, 2)
    variance = 1 + (variance - variance.min()) * rng.uniform(1, 5)
    ratio = np.log(variance[fit].mean()) - np.log(variance[fit]).mean()
    return np.sqrt(variance), float(ratio)


def two_states(rng: np.random.Generator, b: RangeBench) -> tuple[Array, float]:
    """Return the error of a sensor that jumps between two states at random, and the size of its jumps."""
    jump = float(np.median(b.noise)) * rng.uniform(6, 14)
    state = np.zeros(b.n, int)
    for k in range(1, b.n):
        state[k] = state[k - 1] ^ int(rng.random() < JUMP_CHANCE)
    return jump * (state - 0.5), jump

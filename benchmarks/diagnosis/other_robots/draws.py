"""Random draws. Every function takes a generator, and the order of its draws fixes the bytes of a case."""

from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]
Item = TypeVar("Item")
SHARES = {"one": 0.40, "two": 0.25, "none": 0.15, "outside": 0.20}
HIDDEN = {"one": 1, "two": 2, "none": 0, "outside": 1}
"""How many effects a case of a category hides."""


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a draw whose logarithm is uniform."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def significant(value: float, digits: int = 4) -> float:
    """Return the value rounded to a number of significant digits."""
    return float(f"{value:.{digits}g}")


def pick(rng: np.random.Generator, options: Sequence[Item], weights: Sequence[float] | None = None) -> Item:
    """Return one of the options."""
    chances = None if weights is None else np.asarray(weights, float) / np.sum(weights)
    return options[int(rng.choice(len(options), p=chances))]


def categories(rng: np.random.Generator, count: int) -> list[str]:
    """Return shuffled categories in exact shares, up to rounding."""
    drawn = [category for category, share in SHARES.items() for _ in range(int(share * count))]
    while len(drawn) < count:
        drawn.append(pick(rng, list(SHARES), list(SHARES.values())))
    return [drawn[i] for i in rng.permutation(count)]


def draw_deviations(rng: np.random.Generator, count: int) -> Array:
    """Return how far an individual deviates from the nominal parameters, in tolerances."""
    return np.clip(rng.normal(size=count), -2.5, 2.5)


def noise_factor(rng: np.random.Generator) -> float:
    """Return the true noise over the stated one: 1 in half of the cases, else 0.5 to 2."""
    return 1.0 if rng.random() < 0.5 else log_uniform(rng, 0.5, 2.0)


def outlier_share(rng: np.random.Generator, low: float, high: float) -> float:
    """Return the share of outliers, which is zero in 35 % of the cases."""
    share = rng.uniform(low, high)
    return float(pick(rng, [0.0, share], [0.35, 0.65]))


def outlier_sizes(rng: np.random.Generator, count: int, sd: float | Array, largest: float) -> Array:
    """Return errors of 6 to `largest` standard deviations with either sign."""
    return rng.choice([-1, 1], size=count) * sd * np.exp(rng.uniform(np.log(6), np.log(largest), count))


def lost_share(rng: np.random.Generator, highest: float) -> float:
    """Return the share of empty cells, which is zero in half of the cases."""
    return float(rng.uniform(0, highest)) if rng.random() < 0.5 else 0.0


def autoregressive(rng: np.random.Generator, count: int, rho: float) -> Array:
    """Return first-order autoregressive noise of unit variance."""
    white = rng.normal(size=count)
    if rho == 0:
        return white
    noise = np.empty(count)
    noise[0] = white[0]
    gain = np.sqrt(1 - rho * rho)
    for k in range(1, count):
        noise[k] = rho * noise[k - 1] + gain * white[k]
    return noise


def whitened(residuals: Array, rho: float) -> Array:
    """Return residuals without the correlation of first-order autoregressive noise along the last axis."""
    if rho == 0:
        return residuals
    white = residuals.copy()
    white[..., 1:] = (residuals[..., 1:] - rho * residuals[..., :-1]) / np.sqrt(1 - rho * rho)
    return white


def bad_rows(rng: np.random.Generator, count: int, share: float, longest: int = 6) -> Array:
    """Return a mask of about `share` bad rows, alone and in runs, never more than the share."""
    mask = np.zeros(count, bool)
    allowed = int(share * count)
    while mask.sum() < allowed:
        length = int(min(1 if rng.random() < 0.6 else rng.integers(2, longest + 1), allowed - mask.sum()))
        first = int(rng.integers(0, max(1, count - length + 1)))
        mask[first : first + length] = True
    return mask

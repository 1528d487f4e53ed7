"""What a logger does to good readings."""

import numpy as np

from .case import Array

OUTLIER_SIGMAS = (6.0, 25.0)


def correlated(rng: np.random.Generator, shape: tuple[int, ...], correlation: float) -> Array:
    """Normal noise of unit variance, first-order autoregressive along the last axis."""
    noise = rng.standard_normal(shape)
    for k in range(1, shape[-1]):
        noise[..., k] = correlation * noise[..., k - 1] + np.sqrt(1.0 - correlation**2) * noise[..., k]
    return noise


def with_outliers(rng: np.random.Generator, values: Array, sigma: Array | float, share: float) -> Array:
    hit = rng.random(values.shape) < share
    size = rng.uniform(*OUTLIER_SIGMAS, values.shape) * rng.choice([-1.0, 1.0], values.shape)
    return np.where(hit, values + size * sigma, values)


def with_dropouts(rng: np.random.Generator, values: Array, share: float) -> Array:
    return np.where(rng.random(values.shape) < share, np.nan, values)


def share(rng: np.random.Generator, most: float) -> float:
    """Of bad readings: none in every third case."""
    return float(rng.uniform(0.0, most)) if rng.random() > 1 / 3 else 0.0

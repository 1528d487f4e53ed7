"""What a logger does to good readings."""

import numpy as np

from .case import Array

OUTLIER_SIGMAS = (6.0, 25.0)


def white(rng: np.random.Generator, shape: tuple[int, ...], degrees: float = np.inf) -> Array:
    """Noise of unit variance; Student's t for finite degrees of freedom."""
    if np.isinf(degrees):
        return rng.standard_normal(shape)
    return np.sqrt((degrees - 2.0) / degrees) * rng.standard_t(degrees, shape)


def correlated(rng: np.random.Generator, shape: tuple[int, ...], correlation: float, degrees: float = np.inf) -> Array:
    """Noise of unit variance, first-order autoregressive along the last axis."""
    noise = white(rng, shape, degrees)
    if correlation == 0.0:
        return noise
    for k in range(1, shape[-1]):
        noise[..., k] = correlation * noise[..., k - 1] + np.sqrt(1.0 - correlation**2) * noise[..., k]
    return noise


def with_outliers(
    rng: np.random.Generator, values: Array, sigma: Array | float, share: float, struck: Array | None = None
) -> Array:
    """Values with that share of outliers, or with those that are given in sigmas."""
    if struck is not None:
        return values + struck.reshape(values.shape) * sigma
    hit = rng.random(values.shape) < share
    size = rng.uniform(*OUTLIER_SIGMAS, values.shape) * rng.choice([-1.0, 1.0], values.shape)
    return np.where(hit, values + size * sigma, values)


def with_dropouts(rng: np.random.Generator, values: Array, share: float) -> Array:
    return np.where(rng.random(values.shape) < share, np.nan, values)


def share(rng: np.random.Generator, most: float) -> float:
    """Of bad readings: none in every third case."""
    return float(rng.uniform(0.0, most)) if rng.random() > 1 / 3 else 0.0

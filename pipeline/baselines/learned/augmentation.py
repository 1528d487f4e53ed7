"""Random changes of readings in training, so that the network learns no one light, camera or sensor by heart."""

import numpy as np

from pipeline.baselines.learned.readings import NetworkReadings
from symolo.core.arrays import Array
from symolo.dataset.tables.rows import Ints

GAIN, GAMMA, SHIFT = (0.6, 1.5), (0.7, 1.4), (-0.1, 0.1)
"""Ranges of contrast, gamma and brightness."""
MAX_NOISE = 0.05
PATTERNS, MAX_PATTERN = ((3, 4), (6, 8), (12, 16), (24, 32)), 0.12
"""Rows and columns of random patterns, from shadows to the grain of a floor, and the largest amplitude of each."""
BLURRED = 0.3
"""Share of the images that are blurred."""
COVERED = 0.3
"""Share of the images in which a rectangle is covered."""
RANGE_SD, RANGE_SCALE_SD = 0.01, 0.02
"""Standard deviations of the noise of a range, as a share of the longest one, and of its scale."""
LOST = 0.1
"""Share of the ranges that are lost."""


def augmented(readings: NetworkReadings, rows: Ints, rng: np.random.Generator) -> NetworkReadings:
    """Return changed copies of the readings in some rows (B,)."""
    return NetworkReadings(_grey(readings.grey[rows], rng), _ranges(readings.ranges[rows], rng))


def _grey(grey: Array, rng: np.random.Generator) -> Array:
    count, height, width = grey.shape
    gain, gamma, shift, noise = (
        rng.uniform(low, high, (count, 1, 1)) for low, high in (GAIN, GAMMA, SHIFT, (0.0, MAX_NOISE))
    )
    blurred = rng.random(count) < BLURRED
    image = grey.copy()
    image[blurred] = _blurred(image[blurred])
    image = gain * np.clip(image, 0.0, 1.0) ** gamma + shift
    image += noise * rng.standard_normal(image.shape)
    for rows, columns in PATTERNS:
        amplitude = rng.uniform(0.0, MAX_PATTERN, (count, 1, 1))
        image += amplitude * _stretched(rng.standard_normal((count, rows, columns)), height, width)
    for index in np.flatnonzero(rng.random(count) < COVERED):
        tall, wide = rng.integers(4, height // 3), rng.integers(4, width // 3)
        top, left = rng.integers(0, height - tall), rng.integers(0, width - wide)
        image[index, top : top + tall, left : left + wide] = rng.random()
    return np.clip(image, 0.0, 1.0)


def _stretched(pattern: Array, height: int, width: int) -> Array:
    """Return the patterns (K, r, c) as images (K, height, width), by linear interpolation along both axes."""
    for axis, size in ((1, height), (2, width)):
        place = np.linspace(0.0, pattern.shape[axis] - 1.0, size)
        low = np.minimum(place.astype(int), pattern.shape[axis] - 2)
        share = (place - low)[:, None] if axis == 1 else place - low
        lower, upper = np.take(pattern, low, axis=axis), np.take(pattern, low + 1, axis=axis)
        pattern = lower + share * (upper - lower)
    return pattern


def _blurred(image: Array) -> Array:
    """Return the images (K, h, w) under the binomial filter 1 2 1 along both axes."""
    for axis in (1, 2):
        padded = np.pad(image, [(1, 1) if axis == each else (0, 0) for each in range(3)], mode="edge")
        parts = [np.take(padded, np.arange(image.shape[axis]) + offset, axis=axis) for offset in range(3)]
        image = 0.25 * parts[0] + 0.5 * parts[1] + 0.25 * parts[2]
    return image


def _ranges(ranges: Array, rng: np.random.Generator) -> Array:
    target, share = ranges[:, :3], ranges[:, 3:]
    scale = 1.0 + RANGE_SCALE_SD * rng.standard_normal(share.shape)
    changed = share * scale + RANGE_SD * rng.standard_normal(share.shape)
    target = target * (rng.random(target.shape) >= LOST)
    return np.column_stack((target, changed * target))

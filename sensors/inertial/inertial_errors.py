"""The errors of the three axes of an accelerometer or gyroscope, given by the terms of their Allan deviation.

A sensor at rest with a white noise N, a bias instability B and a random walk K of its bias has the Allan variance

    s^2(tau) = N^2 / tau + 2 ln 2 / pi B^2 + K^2 tau / 3

(IEEE Std 952-1997, annex C). N is the noise density of data sheets: the standard deviation of a sample is N / sqrt(T)
for samples that are T apart.

The bias instability is flicker noise, whose spectrum is B^2 / (pi f) on one side. A sum of first-order Gauss-Markov
processes with correlation times that are evenly spaced on a log scale has this spectrum: with a spacing of d in ln T
and a variance of s^2 each, the sum of 4 s^2 T / (1 + (2 pi f T)^2) is close to s^2 / (d f), so s^2 = d B^2 / pi.
"""

from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array

FLICKER = 2.0 * np.log(2.0) / np.pi
"""Allan variance of flicker noise of a bias instability of 1, at any averaging time."""
SHORTEST_S, LONGEST_S, PER_DECADE = 0.1, 10_000.0, 2
"""Correlation times of the processes whose sum is the flicker noise, which is flat within 4 % from 1 s to 2000 s."""
BLOCK = 256
"""Number of samples whose errors are computed together, which is ten times as fast as one at a time."""


@dataclass(frozen=True)
class ErrorSizes:
    """Sizes of the errors of three axes, in the unit u of the axes: m/s^2 or rad/s."""

    noise_density: float
    """White noise N [u / sqrt(Hz)]."""
    bias_instability: float
    """Bias instability B [u]; the lowest Allan deviation is about 0.664 B."""
    random_walk: float
    """Random walk K of the bias [u / sqrt(s)]."""
    bias_sd: float
    """Standard deviation of the bias when the sensor is switched on [u]."""
    bias_per_K_sd: float
    """Standard deviation of the growth of the bias with the temperature [u / K]."""
    scale_sd: float
    """Standard deviation of the relative errors of the scale factors."""
    misalignment_sd: float
    """Standard deviation of the share of each axis that another axis reads; about the angle in rad."""
    range: float
    """Largest reading [u]."""


@dataclass(frozen=True)
class FixedErrors:
    """Errors that are drawn once per run."""

    bias: Array
    """(3,), bias when the sensor is switched on."""
    bias_per_K: Array
    """(3,), growth of the bias with the temperature."""
    sensitivity: Array
    """(3, 3), reading over true value: scale factors on the diagonal, cross-axis sensitivities beside it."""

    @classmethod
    def drawn(cls, sizes: ErrorSizes, rng: np.random.Generator) -> "FixedErrors":
        bias = sizes.bias_sd * rng.standard_normal(3)
        bias_per_K = sizes.bias_per_K_sd * rng.standard_normal(3)
        crossed = sizes.misalignment_sd * rng.standard_normal((3, 3))
        np.fill_diagonal(crossed, 1.0 + sizes.scale_sd * rng.standard_normal(3))
        return cls(bias, bias_per_K, crossed)


class RandomErrors:
    """The sum of white noise, flicker noise and random walk at the times of the samples."""

    def __init__(self, sizes: ErrorSizes, period_s: float, rng: np.random.Generator) -> None:
        self._rng = rng
        self._white = sizes.noise_density / np.sqrt(period_s)
        self._walk = sizes.random_walk * np.sqrt(period_s)
        decades = np.log10(LONGEST_S / SHORTEST_S)
        self._keep = np.exp(-period_s / np.geomspace(SHORTEST_S, LONGEST_S, 1 + round(PER_DECADE * decades)))
        self._flicker_sd = sizes.bias_instability * np.sqrt(np.log(10.0) / PER_DECADE / np.pi)
        self._flicker = self._flicker_sd * rng.standard_normal((len(self._keep), 3))
        self._bias = np.zeros(3)
        self._coming: list[Array] = []

    def next(self) -> Array:
        """Return the errors (3,) of the next sample."""
        if not self._coming:
            self._coming = list(self.block(BLOCK)[::-1])
        return self._coming.pop()

    def block(self, count: int) -> Array:
        """Return the errors of the next samples, (count, 3). Blocks of another size give other numbers."""
        from scipy.signal import lfilter  # noqa: PLC0415 - the settings of this sensor are read without scipy

        errors = self._white * self._rng.standard_normal((count, 3))
        walk = self._bias + np.cumsum(self._walk * self._rng.standard_normal((count, 3)), axis=0)
        self._bias = walk[-1]
        for number, keep in enumerate(self._keep.tolist()):
            push = self._flicker_sd * np.sqrt(1.0 - keep**2) * self._rng.standard_normal((count, 3))
            process, _ = lfilter([1.0], [1.0, -keep], push, axis=0, zi=keep * self._flicker[None, number])
            self._flicker[number] = process[-1]
            errors += process
        return errors + walk

"""Noise of a range sensor that grows with the distance as a polynomial."""

import numpy as np

from benchmarks.diagnosis.other_robots.draws import Array, significant

ROUNDING_M2 = 1e-6 / 12
"""Variance of the rounding to a millimetre."""


def polynomial_mm(first: float, top: float, span: float, parts: Array) -> list[float]:
    """Return coefficients of a noise that is `first` at the origin and `top` at the span, with shares of the powers."""
    higher = [significant((top - first) * parts[k] / span ** (k + 1), 3) for k in range(3)]
    return [significant(first, 3), *higher]


def stated_noise(polynomial: list[float], origin: float, d: Array | float) -> Array:
    """Return the stated noise in metres at some distances."""
    return np.polyval(polynomial[::-1], np.maximum(0, d - origin)) / 1000

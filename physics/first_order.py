"""First-order lag, exact for an input that is held."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NO_TIME_S = 1e-300
"""Stands for a time constant of 0, after which nothing is left in any time."""


def relaxed(held: Array, wanted: Array, duration_s: float | Array, time_constant_s: float | Array) -> Array:
    """What `held` has become after `duration_s` on its way to `wanted`; all broadcast."""
    return wanted + (held - wanted) * np.exp(-duration_s / np.maximum(time_constant_s, NO_TIME_S))

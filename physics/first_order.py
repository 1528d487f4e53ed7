"""First-order lag, exact for an input that is held."""

from math import exp

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def relaxed(held: Array, wanted: Array, duration_s: float, time_constant_s: float) -> Array:
    """What `held` has become after `duration_s` on its way to `wanted`."""
    if time_constant_s == 0.0:
        return wanted
    return wanted + (held - wanted) * exp(-duration_s / time_constant_s)

"""The logarithm in the error of a VL53L0X (paper section 5.2.2): 0 up to a limit, then ln(distance / limit)."""

import numpy as np

from symolo.core.arrays import Array

NEAR_LIMIT_M = 0.18
"""Distance up to which error and noise are constant."""


def log_beyond_near(range_m: Array) -> Array:
    """Return ln(x / 0.18 m) for distances x from 0.18 m on and 0 below, of the same shape."""
    return np.log(np.maximum(range_m, NEAR_LIMIT_M) / NEAR_LIMIT_M)

"""The logarithm by which a VL53L0X errs (paper section 5.2.2): none up to a limit, ln of the distance from there on."""

import numpy as np

from symolo.core.arrays import Array

NEAR_LIMIT_M = 0.18
"""Below it error and noise are constant."""


def log_beyond_near(range_m: Array) -> Array:
    """ln(x / 0.18 m) from 0.18 m on, 0 below, of the same shape."""
    return np.log(np.maximum(range_m, NEAR_LIMIT_M) / NEAR_LIMIT_M)

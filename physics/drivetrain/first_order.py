"""First-order lag, exact for an input that is held or changes along a straight line."""

import numpy as np

from symolo.core.arrays import Array

NO_TIME_S = 1e-300
"""Stands for a time constant of 0, after which nothing is left in any time."""


def relaxed(held: Array, wanted: Array, duration_s: float | Array, time_constant_s: float | Array) -> Array:
    """What `held` has become after `duration_s` on its way to `wanted`; all broadcast."""
    return wanted + (held - wanted) * np.exp(-duration_s / np.maximum(time_constant_s, NO_TIME_S))


def followed(
    held: Array, first: Array, last: Array, duration_s: float | Array, time_constant_s: float | Array
) -> Array:
    """What `held` has become after `duration_s` > 0 in which its input went straight from `first` to `last`."""
    share = np.maximum(time_constant_s, NO_TIME_S) / duration_s
    behind = -np.expm1(-1.0 / share) * share
    return last + (held - first) * np.exp(-1.0 / share) - (last - first) * behind

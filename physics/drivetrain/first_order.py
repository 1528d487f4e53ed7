"""First-order lag, exact for an input that is constant or changes linearly."""

import numpy as np

from symolo.core.arrays import Array

NO_TIME_S = 1e-300
"""Replaces a time constant of 0, which would divide by zero."""


def lag_of_constant_input(
    state: Array, goal: Array, duration_s: float | Array, time_constant_s: float | Array
) -> Array:
    """Return the state of a lag after `duration_s` with the constant input `goal`; all broadcast."""
    return goal + (state - goal) * np.exp(-duration_s / np.maximum(time_constant_s, NO_TIME_S))


def lag_of_linear_input(
    state: Array, first: Array, last: Array, duration_s: float | Array, time_constant_s: float | Array
) -> Array:
    """Return the state of a lag after `duration_s` > 0 in which its input changes linearly from `first` to `last`."""
    share = np.maximum(time_constant_s, NO_TIME_S) / duration_s
    behind = -np.expm1(-1.0 / share) * share
    return last + (state - first) * np.exp(-1.0 / share) - (last - first) * behind

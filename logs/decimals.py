"""Digits with which a table holds the numbers of a log."""

import numpy as np

from symolo.core.arrays import Array

MAX_DECIMALS = 9
"""Digits after the point of a measurement without digits of its own."""


def decimals_of(values: Array, precision: type[np.floating] = np.float64) -> int:
    """Return the smallest number of digits after the point that all values need, at most `MAX_DECIMALS`.

    Args:
        values: Numbers of any shape; those that are not finite do not count.
        precision: Type that the numbers had in the log; those of single precision need the digits with which they stay
            the same in this type, such as 0.1 for 0.10000000149.
    """
    known = values[np.isfinite(values)]
    for digits in range(MAX_DECIMALS):
        rounded = np.round(known, digits)
        if precision is np.float32 and np.array_equal(rounded.astype(precision), known.astype(precision)):
            return digits
        if np.allclose(known, rounded, rtol=0.0, atol=1e-10):
            return digits
    return MAX_DECIMALS

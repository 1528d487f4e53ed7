"""Where a curve first reaches a level, by which rises and edges are measured."""

import numpy as np

from symolo.core.arrays import Array


def first_reached(x: Array, y: Array, level: float) -> float:
    """Return where y (N,), which begins below `level`, first reaches it, by linear interpolation between points."""
    after = int(np.argmax(y >= level))
    share = (level - y[after - 1]) / (y[after] - y[after - 1])
    return float(x[after - 1] + share * (x[after] - x[after - 1]))

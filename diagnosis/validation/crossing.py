"""Where a curve first comes to a level, by which rises and edges are measured."""

import numpy as np

from symolo.core.arrays import Array


def first_reached(x: Array, y: Array, level: float) -> float:
    """Where y first is at `level`, straight between two points, for a y that begins below it and comes to it; (N,)."""
    after = int(np.argmax(y >= level))
    share = (level - y[after - 1]) / (y[after] - y[after - 1])
    return float(x[after - 1] + share * (x[after] - x[after - 1]))

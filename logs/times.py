"""The usual step between the times of a log."""

import numpy as np

from symolo.core.arrays import Array


def usual_step(steps_s: Array) -> float:
    """Return the median of steps [s]."""
    # Of two steps in the middle the shorter counts, so that a gap is never the usual step.
    return float(np.sort(steps_s)[(len(steps_s) - 1) // 2])

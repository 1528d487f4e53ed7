"""The noise of changes over windows, estimated from the residuals of the nominal robot if no source states it.

Windows that overlap, or that end where another begins, share poses, so the correlation of their noise does not decay
from row to row. The difference of two windows that share no pose has twice the variance of one window, and the slow
changes by a missing effect cancel in it.
"""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from diagnosis.measured.channel import Mask
from diagnosis.measured.noise import MIN_ROWS, trimmed_variance
from symolo.core.arrays import Array


def window_noise(left: Array, trial: NDArray[np.int64], rows: Mask, apart: int) -> float | None:
    """Return the standard deviation of the noise of one window.

    Args:
        left: (n,), measured minus predicted, windows of a trial in the order of time; NaN where not usable.
        trial: (n,), trial of each window.
        rows: (n,), windows that may be used.
        apart: Number of windows to the next one that shares no pose.

    Returns:
        None if there are too few pairs of windows, or no scatter at all.
    """
    together = (trial[apart:] == trial[:-apart]) & rows[apart:] & rows[:-apart]
    differences = (left[apart:] - left[:-apart])[together]
    differences = differences[np.isfinite(differences)]
    if len(differences) < MIN_ROWS:
        return None
    return sqrt(0.5 * trimmed_variance(differences)) or None

"""The noise of changes over windows, where no source states it, from what the nominal robot leaves of them.

Windows that overlap, or that end where another begins, share poses, so that their noise is correlated in a way that is
no decay from row to row. Differences of windows that lie too far apart to share any have twice the variance of one, and
what a missing effect bends slowly drops out of them.
"""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from diagnosis.measured.channel import Mask
from diagnosis.measured.noise import FEWEST, trimmed_variance
from symolo.core.arrays import Array


def window_noise(left: Array, trial: NDArray[np.int64], rows: Mask, apart: int) -> float | None:
    """Standard deviation of the noise of one window.

    Args:
        left: (n,), measured less predicted, windows of a trial in the order of time; NaN where not usable.
        trial: (n,), which trial a window is of.
        rows: (n,), windows that may be looked at.
        apart: Windows from one to the next that shares no pose with it.

    Returns:
        None with too few pairs of windows, or where they do not scatter at all.
    """
    together = (trial[apart:] == trial[:-apart]) & rows[apart:] & rows[:-apart]
    differences = (left[apart:] - left[:-apart])[together]
    differences = differences[np.isfinite(differences)]
    if len(differences) < FEWEST:
        return None
    return sqrt(0.5 * trimmed_variance(differences)) or None

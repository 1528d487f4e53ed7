"""Row of a table that is shown at a time."""

import numpy as np

from symolo.core.arrays import Array


def row_at(t_s: Array, now_s: float) -> int:
    """Return the last row whose time is not after `now_s`, or the first row."""
    return max(int(np.searchsorted(t_s, now_s + 1e-6, side="right")) - 1, 0)

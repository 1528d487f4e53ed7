"""Times at which the rows of a drive were sampled, where the time stamps of the log scatter.

A controller often samples its encoders by a timer, evenly, and stamps the row later, when it has time to write. Between
such stamps a steady wheel seems to change its speed. Other logs have rows at uneven times, and stamps that are right.
The log itself shows which is true, because a wheel has inertia: against the right times, its counts lie on the lines
through their neighbours.
"""

from collections.abc import Sequence

import numpy as np

from diagnosis.measured.screening import GAP, usual
from symolo.core.arrays import Array

ROWS_AROUND = 9
"""Number of rows before and after a long step that show whether rows were lost there, or one row was stamped late."""
SMOOTHER = 0.8
"""Largest roughness against even times, as a share of that against the stamps, for which the even times are taken."""


def even_times(t_s: Array) -> Array:
    """Return the times (N,) of evenly spaced samples, with gaps of whole periods, that fit the stamps (N,) best."""
    steps = np.diff(t_s)
    if len(steps) < 2:
        return t_s
    period_s = float(steps[np.abs(steps - usual(steps)) <= (GAP - 1.0) * usual(steps)].mean())
    number = np.arange(len(t_s), dtype=float)
    for row in (np.flatnonzero(steps > GAP * period_s) + 1).tolist():
        # Rows that were lost move all later stamps; a late stamp is an outlier.
        first, last = max(row - ROWS_AROUND, 0), row + ROWS_AROUND
        late_s = t_s[first:last] - period_s * number[first:last]
        lost = np.rint((np.median(late_s[row - first :]) - np.median(late_s[: row - first])) / period_s)
        if lost > 0.0:
            number[row:] += lost
    slope_s, start_s = np.polyfit(number, t_s, 1)
    return start_s + slope_s * number


def are_even(stamps_s: Sequence[Array], even_s: Sequence[Array], columns: Sequence[Sequence[Array]]) -> bool:
    """Return whether columns are smoother against even times than against the stamps, (N,) each of a trial."""
    rough = np.zeros(2)
    for stamps, even, values in zip(stamps_s, even_s, columns, strict=True):
        for column in values:
            rough += [_roughness(stamps, column), _roughness(even, column)]
    return bool(rough[1] < SMOOTHER * rough[0])


def _roughness(t_s: Array, values: Array) -> float:
    """Return the sum of the distances of values (N,) from the line through both neighbours; NaN are left out."""
    if len(t_s) < 3:
        return 0.0
    before, after = np.diff(t_s)[:-1], np.diff(t_s)[1:]
    line = (values[:-2] * after + values[2:] * before) / (before + after)
    joined = np.maximum(before, after) <= GAP * usual(np.diff(t_s))
    return float(np.nansum(np.abs(values[1:-1] - line)[joined]))

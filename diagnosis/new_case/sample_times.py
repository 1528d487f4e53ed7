"""Times at which the rows of a drive were sampled, where the time stamps of the log scatter.

A controller often samples its encoders by a timer, evenly, and stamps the row later, when it has time to write. Between
such stamps a steady wheel seems to change its speed. Other logs have rows at uneven times, and stamps that are right.
The log itself shows which is true, because a wheel has inertia: against the right times, its counts lie on the lines
through their neighbours.
"""

from collections.abc import Sequence
from math import ceil

import numpy as np

from diagnosis.importers.drive_log import ROW_S
from diagnosis.measured.screening import GAP
from logs.times import usual_step
from symolo.core.arrays import Array

ROWS_AROUND = 9
"""Number of rows before and after a long step that show whether rows were lost there, or one row was stamped late."""
SMOOTHER = 0.8
"""Largest roughness against even times, as a share of that against the stamps, for which the even times are taken."""
EVEN, SHARE_OF_EVEN = 0.1, 0.9
"""Largest difference from the usual step of a log, as a share, and the share of its steps within it, for even rows."""
STAMP_ROUNDING = 1e-4
"""Differences, as a share, that come from rounded times."""
ROUNDING = 1e-12
"""Roughness of a column at rest by rounding, as a share of its values, with a wide margin."""


def even_times(t_s: Array) -> Array:
    """Return the times (N,) of evenly spaced samples, with gaps of whole periods, that fit the stamps (N,) best."""
    steps = np.diff(t_s)
    if len(steps) < 2:
        return t_s
    period_s = float(steps[np.abs(steps - usual_step(steps)) <= (GAP - 1.0) * usual_step(steps)].mean())
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


def row_of_drive_s(steps: Array) -> float:
    """Return the time between the rows of a drive: that of whole rows of the log if they are even and as fast.

    Between rows, counts do not lie on a line while the wheel speeds up, and the line would change its speed.
    """
    step_s = usual_step(steps)
    near = np.abs(steps - step_s) <= EVEN * step_s
    if step_s > ROW_S or np.mean(near) < SHARE_OF_EVEN:
        return ROW_S
    period_s = float(steps[near].mean())
    # Of two numbers of rows that are equally near, the smaller one counts.
    row_s = max(1, ceil(ROW_S / period_s - 0.5 - STAMP_ROUNDING)) * period_s
    return ROW_S if abs(row_s - ROW_S) <= STAMP_ROUNDING * ROW_S else row_s


def are_even(stamps_s: Sequence[Array], even_s: Sequence[Array], columns: Sequence[Sequence[Array]]) -> bool:
    """Return whether columns are smoother against even times than against the stamps.

    Columns may have different units, so that each is compared with itself, and the geometric mean of the ratios counts.

    Args:
        stamps_s: (N,) stamps of each trial.
        even_s: (N,) even times of each trial.
        columns: (N,) values of each trial and column; every trial has the same columns.
    """
    log_ratios = []
    for trial_values in zip(*columns, strict=True):
        against_stamps = sum(map(_roughness, stamps_s, trial_values))
        against_even = sum(map(_roughness, even_s, trial_values))
        rounding = ROUNDING * sum(float(np.nansum(np.abs(values))) for values in trial_values)
        if max(against_even, against_stamps) > rounding:
            log_ratios.append(np.log((against_even + rounding) / (against_stamps + rounding)))
    return bool(log_ratios) and bool(np.mean(log_ratios) < np.log(SMOOTHER))


def _roughness(t_s: Array, values: Array) -> float:
    """Return the sum of the distances of values (N,) from the line through both neighbours; NaN are left out."""
    if len(t_s) < 3:
        return 0.0
    before, after = np.diff(t_s)[:-1], np.diff(t_s)[1:]
    # Three rows with one stamp have no line; their mean is its limit for equal steps.
    share = np.divide(before, before + after, out=np.full_like(before, 0.5), where=before + after > 0.0)
    line = (1.0 - share) * values[:-2] + share * values[2:]
    joined = np.maximum(before, after) <= GAP * usual_step(np.diff(t_s))
    return float(np.nansum(np.abs(values[1:-1] - line)[joined]))

"""The usual step between the times of a log, gaps, and times that go back."""

import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.progress import plural

MAX_OFF_STEPS = 0.5
"""How far, in usual steps, the time between the rows before and after those out of order may be from whole steps."""
MAX_OFF_SCATTER, SCATTER_SHARE, MAX_OFF_UNEVEN_STEPS = 1.5, 0.9, 0.9
"""The same for an uneven clock: a multiple of the difference from the usual step that this share of the steps has at
most, but less than a whole step."""


def usual_step(steps_s: Array) -> float:
    """Return the median of steps [s]."""
    # Of two steps in the middle the shorter counts, so that a gap is never the usual step.
    return float(np.sort(steps_s)[(len(steps_s) - 1) // 2])


def gap_note(t_s: Array, min_steps: float) -> str:
    """Return a sentence about gaps of time; empty if there is none.

    Args:
        t_s: (N,), increasing times.
        min_steps: Smallest gap, as a multiple of the usual step.
    """
    steps_s = np.diff(t_s)
    usual_s = usual_step(steps_s) if len(steps_s) else 0.0
    gaps = np.flatnonzero(steps_s > min_steps * usual_s)
    if not len(gaps):
        return ""
    longest = int(gaps[np.argmax(steps_s[gaps])])
    return (
        f"rows are usually {usual_s:.4g} s apart, but {plural(len(gaps), 'gap')} of time"
        f" {'is' if len(gaps) == 1 else 'are'} more than {min_steps:g} times as long;"
        f" the longest gap is {steps_s[longest]:.4g} s, from t = {t_s[longest] - t_s[0]:.3f} s on"
    )


def stray_rows(t_s: Array) -> NDArray[np.bool_]:
    """Return which rows (N,) have a time that alone is out of order, while those before and after it belong together.

    Args:
        t_s: (N,), times; where the time goes back and goes on from there, something new begins.
    """
    stray = np.zeros(len(t_s), dtype=bool)
    steps_s = np.diff(t_s)
    back = np.flatnonzero(steps_s < 0.0) + 1
    if not len(back) or not np.any(steps_s > 0.0):
        return stray
    ahead_s = steps_s[steps_s > 0.0]
    usual_s = usual_step(ahead_s)
    scatter_s = float(np.quantile(np.abs(ahead_s - usual_s), SCATTER_SHARE))
    max_off_s = max(MAX_OFF_STEPS * usual_s, min(MAX_OFF_SCATTER * scatter_s, MAX_OFF_UNEVEN_STEPS * usual_s))
    for row in back:
        one = _stray(t_s, int(row), usual_s, max_off_s)
        if one is not None:
            stray[one] = True
    return stray


def _stray(t_s: Array, row: int, usual_s: float, max_off_s: float) -> int | None:
    """Return the row that is out of order where the time goes back at a row; None if something new begins there."""
    last = len(t_s) - 1

    def are_apart(first: int, second: int) -> bool:
        is_inside = first >= 0 and second <= last
        if not is_inside or t_s[second] <= t_s[first]:
            return False
        return bool(abs(t_s[second] - t_s[first] - (second - first) * usual_s) <= max_off_s)

    # Either this row is too early, or the one before it is too late, or the two are exchanged.
    for one in (row, row - 1):
        if are_apart(one - 1, one + 1):
            return one
    if are_apart(row - 2, row + 1) and t_s[row - 2] < t_s[row] and t_s[row - 1] < t_s[row + 1]:
        return row
    # A first or last row that does not belong to the two beside it would be a trial of its own.
    if row == 1 < last and t_s[1] < t_s[2]:
        return 0
    return last if row == last > 1 and t_s[last - 2] < t_s[last - 1] else None


def goes_back(by_s: float, where: str) -> InputError:
    """Return the error for a row of a log whose time is earlier than that of the row above."""
    cure = "sort the rows by time, or make each part a log of its own"
    return InputError(f"the time goes back by {by_s:.4g} s", where=where, cure=cure)

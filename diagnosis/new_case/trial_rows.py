"""Which rows of a log belong to which trial, and which are left out because of their times."""

import numpy as np
from numpy.typing import NDArray

from diagnosis.measured.measurement import CaseKind
from logs.log_file import LogFile
from logs.mapping import MAPPING
from logs.times import goes_back, stray_rows
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.progress import plural

IN_TIME = frozenset({CaseKind.DRIVE_LOG, CaseKind.MOTOR_STEP})
"""Kinds whose rows follow each other in time."""
LONGEST_GAP_S = 3600.0
"""Longest gap within a trial; a longer one is a broken time stamp, or two logs in one file."""
MIN_STRAY, MAX_STRAY_SHARE = 3, 0.02
"""Number of rows whose times are out of order that are left out in any case, and the largest share of them."""

Rows = NDArray[np.int64]


def rows_of_trials(t_s: Array, group: Array | None, kind: CaseKind, log: LogFile, notes: list[str]) -> list[Rows]:
    """Return the rows of each trial: those of the column, or else a new one wherever the time goes back.

    Args:
        t_s: (N,), times of the rows.
        group: (N,), number of the trial of each row; None if the log has none.
        kind: Kind of the case.
        log: The log.
        notes: Gets what is left out.

    Raises:
        InputError: The time goes back within a trial, at most rows, or on a range bench, which has one trial only; it
            jumps far ahead; or many times are out of order.
    """
    used = _rows_in_order(t_s, group, log, notes) if kind in IN_TIME else np.arange(len(t_s))
    steps = np.diff(t_s[used])
    new = steps < 0.0 if group is None else np.diff(group[used]) != 0.0
    if group is None and 2 * np.count_nonzero(new) > len(steps):
        first = int(np.argmax(new))
        raise goes_back(float(-steps[first]), log.where(int(used[first + 1])))
    if kind is CaseKind.TOF_BENCH and new.any():
        cure = f"sort the rows by time, or leave t_s out of {MAPPING}"
        raise InputError("the time goes back", where=log.where(int(np.argmax(new)) + 1), cure=cure)
    is_used = np.concatenate([[True], new | (steps != 0.0)])
    number = np.concatenate([[0], np.cumsum(new)])
    trials = [used[(number == trial) & is_used] for trial in range(int(number[-1]) + 1)]
    if group is None and new.any() and kind in IN_TIME:
        first = log.row(int(used[int(np.argmax(new)) + 1]))
        shortest = plural(min(map(len, trials)), "row")
        notes.append(
            f"the time goes back {plural(np.count_nonzero(new), 'time')} (first in {first}); a new trial begins at each"
            f" of these rows, and the shortest has {shortest}"
        )
    if not is_used.all():
        repeated = plural(np.count_nonzero(~is_used), "row")
        notes.append(f"left out, because the time of the row above is repeated: {repeated}")
    if kind in IN_TIME:
        for rows in trials:
            _check_steps(t_s[rows], rows, log)
    return trials


def _rows_in_order(t_s: Array, group: Array | None, log: LogFile, notes: list[str]) -> Rows:
    """Return the rows without those whose time alone is out of order.

    Raises:
        InputError: There are so many of them that the clock cannot be trusted.
    """
    begins = np.flatnonzero(np.diff(group)) + 1 if group is not None else []
    stray = np.concatenate([stray_rows(part_s) for part_s in np.split(t_s, begins)])
    count = int(np.count_nonzero(stray))
    if count > max(MIN_STRAY, MAX_STRAY_SHARE * len(t_s)):
        raise InputError(
            f"the times of {count} of {len(t_s)} rows are out of order",
            where=log.where(int(np.argmax(stray))),
            allowed=f"at most {100 * MAX_STRAY_SHARE:g} % of the rows, or {MIN_STRAY} in a short log",
            cure="repair or remove them",
        )
    if count:
        notes.append(_stray_note(stray, log))
    return np.flatnonzero(~stray)


def _stray_note(stray: NDArray[np.bool_], log: LogFile) -> str:
    first, count = log.row(int(np.argmax(stray))), int(np.count_nonzero(stray))
    others = f" and {plural(count - 1, 'other')}" if count > 1 else ""
    return f"left out, because its time alone is out of order: {first}{others}"


def _check_steps(t_s: Array, rows: Rows, log: LogFile) -> None:
    """Refuse a trial, whose rows of the log are given, in which the time goes back or jumps far ahead."""
    steps = np.diff(t_s)
    wrong = np.flatnonzero((steps < 0.0) | (steps > LONGEST_GAP_S)).tolist()
    if not wrong:
        return
    where = log.where(int(rows[wrong[0] + 1]))
    if steps[wrong[0]] < 0.0:
        raise InputError("the time goes back within a trial", where=where)
    cure = "repair or remove the row, or begin a new trial there with a column trial"
    raise InputError(f"the time goes on by {steps[wrong[0]]:.4g} s", where=where, cure=cure)

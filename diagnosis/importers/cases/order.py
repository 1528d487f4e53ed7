"""Checks of the times of a log: increasing, on one clock, and from the start of each trial."""

from collections.abc import Sequence

import numpy as np

from diagnosis.measured.channel import Mask
from diagnosis.measured.screening import GAP
from logs.times import usual_step
from logs.units.plausible import mixed_up_unit
from symolo.core.errors import InputError
from symolo.core.tables.table import CsvTable

LATEST_START = 5.0
"""Latest time of the first row of a trial, in periods after rest."""


def check_increasing(table: CsvTable, column: str, within: Mask | None = None) -> None:
    """Refuse a column that does not increase from each row to the next.

    Args:
        table: The log.
        column: Name of the column.
        within: (N - 1,), whether a row and the next are of the same trial; all by default.

    Raises:
        InputError: A value does not increase; the message names the first such row.
    """
    values = table.numbers[column]
    falls = np.diff(values) <= 0.0
    wrong = np.flatnonzero(falls if within is None else within & falls)
    if len(wrong):
        i = int(wrong[0]) + 1
        how = "repeats" if values[i] == values[i - 1] else "goes back from"
        what = f"column {column}: {values[i]:.10g} {how} {values[i - 1]:.10g} of the row above"
        raise InputError(what, where=table.where(i), cure="put the rows in order, and keep one of each time")


def check_session(table: CsvTable, within: Mask) -> None:
    """Refuse a trial in which `session_time_s` and `t_s` drift apart by more than about a period.

    Args:
        table: The log with both columns, each of which increases within a trial.
        within: (N - 1,), whether a row and the next are of the same trial.

    Raises:
        InputError: They drift apart; the message names the first such row, or the unit that one column seems to be in.
    """
    t_s, session_s = table.numbers["t_s"], table.numbers["session_time_s"]
    steps_s, session_steps_s = np.diff(t_s), np.diff(session_s)
    if not within.any():
        return
    begins = np.concatenate([[True], ~within])
    offset_s = session_s - t_s
    drift_s = np.abs(offset_s - offset_s[begins][np.cumsum(begins) - 1])
    apart = np.flatnonzero(drift_s > GAP * usual_step(np.minimum(steps_s, session_steps_s)[within])).tolist()
    if not apart:
        return
    i = apart[0]
    ratio = float(np.median((session_steps_s / np.where(within, steps_s, 1.0))[within]))
    for name, other, factor in (("session_time_s", "t_s", ratio), ("t_s", "session_time_s", 1.0 / ratio)):
        unit = mixed_up_unit(factor, "s")
        if unit:
            rows_s = usual_step((session_steps_s if name == "session_time_s" else steps_s)[within])
            what = f"column {name}: rows are {rows_s:.4g} s apart, {factor:.4g} times as far as by {other}"
            raise InputError(what, where=table.where(i), cure=f"this looks like {unit}")
    steps = f"goes {session_steps_s[i - 1]:.4g} s on from the row above, and t_s {steps_s[i - 1]:.4g} s"
    what = f"column session_time_s: {steps}; {drift_s[i]:.4g} s apart since the trial began"
    raise InputError(what, where=table.where(i), cure="count both by one clock, or make it a trial of its own")


def check_from_rest(table: CsvTable, starts: Sequence[int], within: Mask) -> None:
    """Refuse a trial that does not begin at rest at `t_s` = 0, or a few periods after it.

    Args:
        table: The log.
        starts: Index of the first row of each trial.
        within: (N - 1,), whether a row and the next are of the same trial.

    Raises:
        InputError: A trial begins later or earlier; the message names its first row.
    """
    t_s = table.numbers["t_s"]
    if not within.any():
        return
    period_s = usual_step(np.diff(t_s)[within])
    for i in starts:
        if not -0.5 * period_s < t_s[i] <= LATEST_START * period_s:
            name = f"trial {table.numbers['trial'][i]:.0f} " if "trial" in table.numbers else ""
            raise InputError(
                f"column t_s: {name}begins at {t_s[i]:.10g} s",
                where=table.where(i),
                allowed=f"0 to {LATEST_START * period_s:.4g} s, as each trial starts at rest at t_s = 0",
                cure="count t_s of each trial from when the motor was at rest",
            )

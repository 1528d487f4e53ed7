"""Conversion of the rows of a case into trials, in the order in which they were measured."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from diagnosis.importers.cases.order import check_from_rest, check_increasing, check_session
from diagnosis.measured.case_files.case_format import CAMERA_CHANNELS, NO_TARGET_FROM_M, RANGES
from diagnosis.measured.case_files.csv_table import MeasuredColumn
from diagnosis.measured.channel import Channel, Label, Mask
from diagnosis.measured.measurement import Trial
from symolo.core.arrays import Array
from symolo.core.errors import FaultList, InputError
from symolo.core.tables.table import CsvTable
from symolo.core.tables.time_series import TimeSeries


@dataclass(frozen=True)
class KnownNoise:
    """Noise of one channel as nominal.yaml states it."""

    sd: Array
    """(N,), standard deviation in each row of the table, in the unit of the channel."""
    correlation: float = 0.0
    """Correlation of the noise of two successive rows."""

    @classmethod
    def constant(cls, sd: float, table: CsvTable, correlation: float = 0.0) -> "KnownNoise":
        """Return noise that is the same in every row."""
        return cls(np.full(len(table.row), sd), correlation)


def trials_of(
    table: CsvTable,
    channels: Sequence[MeasuredColumn],
    holdout: Mask,
    noise: Mapping[str, KnownNoise],
    *,
    from_rest: bool,
) -> tuple[Trial, ...]:
    """Return one trial for each sweep or trial of a table, or a single trial if the table has no such column.

    Args:
        table: The table, with a column t_s.
        channels: Columns of the table that are channels.
        holdout: (N,), rows that are held out.
        noise: Stated noise by channel.
        from_rest: Whether each trial starts at rest at `t_s` = 0.

    Raises:
        InputError: The rows of a trial are not together, or their times do not increase from the start of the trial.
    """
    group = next((name for name in ("sweep", "trial") if name in table.numbers), "")
    numbers = table.numbers[group] if group else np.ones(len(table.row))
    _check_order(table, numbers, group)
    starts = [0, *(np.flatnonzero(np.diff(numbers)) + 1).tolist(), len(numbers)]
    if from_rest:
        check_from_rest(table, starts[:-1], np.diff(numbers) == 0.0)
    return tuple(
        _trial(table, channels, holdout, noise, rows=slice(a, b), name=f"{numbers[a]:.0f}") for a, b in pairwise(starts)
    )


def _check_order(table: CsvTable, numbers: Array, group: str) -> None:
    """Refuse a trial whose rows are not together or not in the order of time; all such faults are reported."""
    faults = FaultList()
    changes = np.flatnonzero(np.diff(numbers)) + 1
    with faults.noted():
        _check_together(table, numbers, changes.tolist(), group)
    within = np.ones(len(numbers) - 1, dtype=bool)
    within[changes - 1] = group == "sweep"  # on a bench, the time continues from one sweep to the next
    with faults.noted():
        check_increasing(table, "t_s", within)
    if "row" in table.numbers:
        with faults.noted():
            check_increasing(table, "row")
    if "session_time_s" in table.numbers:
        with faults.noted():
            check_increasing(table, "session_time_s", within)
    faults.check()
    if "session_time_s" in table.numbers:
        back = changes[np.diff(table.numbers["session_time_s"])[changes - 1] < 0.0]
        if len(back):
            what = "column session_time_s: the trial begins before the one above has ended"
            raise InputError(what, where=table.where(int(back[0])), cure="put the trials in order")
        if group == "trial":
            check_session(table, within)


def _check_together(table: CsvTable, numbers: Array, changes: Sequence[int], group: str) -> None:
    seen = {numbers[0]}
    for i in changes:
        if numbers[i] in seen:
            raise InputError(
                f"column {group}: {numbers[i]:.0f} appears again after other rows",
                where=table.where(i),
                cure="sort the rows by it and by time",
            )
        seen.add(numbers[i])


def _trial(
    table: CsvTable,
    channels: Sequence[MeasuredColumn],
    holdout: Mask,
    noise: Mapping[str, KnownNoise],
    *,
    rows: slice,
    name: str,
) -> Trial:
    t_s = table.numbers["t_s"][rows].copy()
    begins_s = float(table.numbers["session_time_s"][rows][0] - t_s[0]) if "session_time_s" in table.numbers else 0.0
    logged = tuple(_channel(column, t_s, table, rows, noise.get(column.name)) for column in channels)
    labels = tuple(Label(word, values[rows]) for word, values in table.words.items() if word != "split")
    return Trial(name, t_s, holdout[rows].copy(), logged, labels, begins_s)


def _channel(column: MeasuredColumn, t_s: Array, table: CsvTable, rows: slice, noise: KnownNoise | None) -> Channel:
    values = table.numbers[column.name][rows].copy()
    return Channel.logged(
        TimeSeries(column.name, column.unit, t_s, values),
        column.role,
        no_target=values >= NO_TARGET_FROM_M if column.name in RANGES else None,
        noise_sd=noise.sd[rows].copy() if noise else None,
        noise_correlation=noise.correlation if noise else 0.0,
        clock="camera" if column.name in CAMERA_CHANNELS else "log",
    )

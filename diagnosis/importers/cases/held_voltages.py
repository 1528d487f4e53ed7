"""Voltages of a drive that change between the rows of data.csv, in a file beside it."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from diagnosis.importers.cases.order import check_increasing
from diagnosis.measured.case_files.case_format import VOLTAGE_COLUMNS, VOLTAGES, WHEEL_VOLTAGES
from diagnosis.measured.case_files.csv_table import read_csv
from diagnosis.measured.measurement import Trial
from diagnosis.measured.zero_order_hold import held_means
from symolo.core.arrays import Array
from symolo.core.errors import FaultList, InputError
from symolo.core.tables.time_series import TimeSeries

MAX_APART_V = 0.02
"""Largest median difference between a mean voltage of data.csv and that of the finer voltages; both are rounded."""


def with_held_voltages(trials: Sequence[Trial], path: Path) -> tuple[Trial, ...]:
    """Return the trials with the voltages of a file.

    Raises:
        InputError: The file breaks the format, or its voltages are not those of the rows; all faults are reported.
    """
    table, faults = read_csv(path, VOLTAGE_COLUMNS), FaultList()
    numbers = table.numbers["trial"]
    with faults.noted():
        check_increasing(table, "t_s", np.diff(numbers) == 0.0)
    names = {trial.name for trial in trials}
    for number in dict.fromkeys(f"{number:.0f}" for number in numbers.tolist()):
        with faults.noted():
            if number not in names:
                raise InputError("column trial", where=str(path), got=number, allowed="the trials of data.csv")
    faults.check()
    voltages = {name: table.numbers[name] for name in WHEEL_VOLTAGES}
    several = []
    for trial in trials:
        rows = numbers == float(trial.name)
        series = [_series(name, table.numbers["t_s"][rows], values[rows]) for name, values in voltages.items()]
        with faults.noted():
            several.append(replace(trial, held_inputs=tuple(_checked(each, trial, path) for each in series)))
    faults.check()
    return tuple(several)


def _series(name: str, t_s: Array, values: Array) -> TimeSeries:
    known = np.isfinite(values)
    return TimeSeries(name, "V", t_s[known].copy(), values[known].copy())


def _checked(series: TimeSeries, trial: Trial, path: Path) -> TimeSeries:
    """Return the voltages of a wheel if they are those of the rows."""
    begins, rows_V = trial.t_s[:-1], trial[series.name].values[:-1]
    if not len(series.t_s) or len(begins) < 1:
        raise InputError(f"trial {trial.name} has no {series.name}", where=str(path), cure="remove the file")
    apart = np.abs(held_means(series.t_s, series.values, begins, np.diff(trial.t_s)) - rows_V)
    apart = apart[np.isfinite(apart)]
    if not len(apart) or np.median(apart) > MAX_APART_V:
        off = f"{np.median(apart):.3g} V apart" if len(apart) else "that has none"
        what = f"{series.name} of trial {trial.name} is not the voltage of data.csv: {off}"
        cure = f"make the case again, or remove {VOLTAGES}"
        raise InputError(what, where=str(path), allowed=f"at most {MAX_APART_V:g} V", cure=cure)
    return series

"""Writer of measured cases: the same rows and values as a measurement, with as many digits as that takes."""

from pathlib import Path

import numpy as np
import yaml

from diagnosis.measured.case_files.case_format import COLUMNS, DATA, HOLDOUT, VOLTAGE_COLUMNS, VOLTAGES, WHEEL_VOLTAGES
from diagnosis.measured.case_files.csv_table import CaseColumn, MeasuredColumn
from diagnosis.measured.case_files.nominal import NOMINAL, KnownMotor, KnownWheels
from diagnosis.measured.measurement import Measurement, Trial
from symolo.core.arrays import Array
from symolo.core.files.atomic_files import make_folder, write_file

MAX_DECIMALS = 12
"""Number of decimals above which a number is written in its shortest form that reads back equal."""
SUM_S = 1e-9
"""Allowed error of a session time [s], which is the rounded sum of the start of a trial and a time in it."""


def write_case(measurement: Measurement, folder: Path) -> None:
    """Write data.csv and nominal.yaml of a measurement into a new folder.

    Raises:
        ValueError: The measurement has no nominal parameters, or the format has no such kind.
    """
    if (
        measurement.nominal is None
        or isinstance(measurement.nominal, (KnownMotor, KnownWheels))
        or measurement.kind not in COLUMNS
    ):
        raise ValueError(f"{measurement.name}: a case needs nominal parameters and one of the kinds {[*COLUMNS]}")
    make_folder(folder)
    write_file(folder / DATA, csv_of(measurement).encode())
    if voltages := voltages_of(measurement):
        write_file(folder / VOLTAGES, voltages.encode())
    nominal = measurement.nominal.model_dump(mode="json")
    write_file(folder / NOMINAL, yaml.safe_dump(nominal, sort_keys=False).encode())


def csv_of(measurement: Measurement) -> str:
    """Return the text of data.csv."""
    columns = COLUMNS[measurement.kind]
    lines = [",".join(column.name for column in columns)]
    before = 0
    for number, trial in enumerate(measurement.trials, 1):
        cells = [_cells(column, trial, number, before) for column in columns]
        lines += [",".join(row) for row in zip(*cells, strict=True)]
        before += len(trial.t_s)
    return "\n".join(lines) + "\n"


def voltages_of(measurement: Measurement) -> str:
    """Return the text of voltages.csv; empty if no voltage changes between the rows."""
    if not any(trial.held_inputs for trial in measurement.trials):
        return ""
    lines = [",".join(column.name for column in VOLTAGE_COLUMNS)]
    decimals = [column.decimals for column in VOLTAGE_COLUMNS]
    for number, trial in enumerate(measurement.trials, 1):
        series = {
            each.name: dict(zip(each.t_s.tolist(), each.values.tolist(), strict=True)) for each in trial.held_inputs
        }
        for time in sorted({time for values in series.values() for time in values}):
            volts = [series.get(name, {}).get(time, np.nan) for name in WHEEL_VOLTAGES]
            name = trial.name if trial.name.isdecimal() else str(number)
            cells = _texts(np.array([time]), decimals[1]) + _texts(np.array(volts), decimals[2])
            lines.append(",".join([name, *cells]))
    return "\n".join(lines) + "\n"


def _cells(column: CaseColumn, trial: Trial, number: int, before: int) -> list[str]:
    rows = len(trial.t_s)
    if not isinstance(column, MeasuredColumn):
        if column.name == "split":
            return [HOLDOUT if held else "fit" for held in trial.holdout]
        return list(trial.label(column.name).values)
    if column.name == "row":
        return [str(before + i + 1) for i in range(rows)]
    if column.name in {"sweep", "trial"}:
        return [trial.name if trial.name.isdecimal() else str(number)] * rows
    if column.name == "t_s":
        return _texts(trial.t_s, column.decimals)
    if column.name == "session_time_s":
        return _texts(trial.t_s + (trial.begins_s or 0.0), column.decimals, within=SUM_S)
    return _texts(trial[column.name].values, column.decimals)


def _texts(values: Array, decimals: int, within: float = 0.0) -> list[str]:
    return ["" if np.isnan(value) else _text(value, decimals, within) for value in values.tolist()]


def _text(value: float, decimals: int, within: float) -> str:
    """Return a number with these decimals, or with more if it would not read back as the value within a tolerance."""
    for digits in range(decimals, MAX_DECIMALS + 1):
        text = f"{round(value, digits) + 0.0:.{digits}f}"
        if abs(float(text) - value) <= within:
            return text
    return repr(value)

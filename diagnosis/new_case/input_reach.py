"""Refusal of single inputs that are out of reach or missing, with the row and the column of the log."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from diagnosis.measured.case_files.case_format import channel_columns
from diagnosis.measured.case_files.csv_table import MeasuredColumn
from diagnosis.measured.channel import Role
from diagnosis.measured.measurement import CaseKind
from logs.log_file import LogFile
from logs.mapping import MAPPING, LogMapping
from logs.units.names import factor_to
from logs.units.plausible import OTHER_UNITS
from symolo.core.arrays import Array
from symolo.core.errors import InputError


def input_faults(mapping: LogMapping, values: Mapping[str, Array], log: LogFile) -> Iterator[InputError]:
    """Yield an error for each input that is out of reach in some row, which no case may have.

    Args:
        mapping: Columns of the log.
        values: (N,) of each quantity, in our units.
        log: The log.
    """
    for column in channel_columns(CaseKind(mapping.kind)):
        if column.role is not Role.INPUT or column.name not in values:
            continue
        beyond = np.flatnonzero(~column.plausible.holds(values[column.name])).tolist()
        if not beyond:
            continue
        source, row = mapping.columns[column.name], beyond[0]
        got = f"{column.name} {values[column.name][row]:.4g}"
        more = f"; rows of this column with such a value: {len(beyond)}" if len(beyond) > 1 else ""
        stated = source.unit or column.unit
        unit = _smaller_unit(column, stated, float(np.nanmax(np.abs(values[column.name]))))
        cure = f"is the column in {unit}? then write unit: {unit} for {column.name} in {MAPPING}; " if unit else ""
        yield InputError(
            f"column {source.column or source.constant}: as {stated} it gives {got}",
            where=log.where(row),
            allowed=column.plausible.words(column.unit),
            cure=f"{cure}{'otherwise, ' if unit else ''}repair or remove the row: inputs must be known{more}",
        )


def missing_inputs(
    mapping: LogMapping, values: Mapping[str, Array], trials: Sequence[Mapping[str, Array]], log: LogFile
) -> Iterator[InputError]:
    """Yield an error for each input that a case needs in every row and that is missing in some.

    Args:
        mapping: Columns of the log.
        values: (N,) of each quantity in the rows of the log.
        trials: Columns of each trial as the case has them, where short gaps may be bridged.
        log: The log.
    """
    for column in channel_columns(CaseKind(mapping.kind)):
        if column.may_be_empty or column.role is not Role.INPUT or column.name not in values:
            continue
        missing = np.flatnonzero(~np.isfinite(values[column.name])).tolist()
        if not missing or all(np.isfinite(trial[column.name]).all() for trial in trials):
            continue
        source = mapping.columns[column.name]
        for name in filter(None, (source.column, source.times)):
            numbers = log.numbers(name)
            rows = [row for row in missing if not np.isfinite(numbers[row])]
            if rows:
                yield _missing_cell(name, rows, log)


def _missing_cell(name: str, rows: Sequence[int], log: LogFile) -> InputError:
    """Return the error of a column that has no number in some rows; the first of them is named."""
    more = f"; rows of this column with such a cell: {len(rows)}" if len(rows) > 1 else ""
    return InputError(
        f"column {name}",
        where=log.where(rows[0]),
        got=log.columns[name][rows[0]],
        allowed="a number",
        cure=f"repair or remove the row: inputs must be known, and only readings may be missing{more}",
    )


def _smaller_unit(column: MeasuredColumn, stated: str, largest: float) -> str:
    """Return the largest unit below the stated one in which all values would be possible; empty if there is none."""
    per_stated = factor_to(column.unit, stated, column.name)
    factors = {unit: 1.0 / per / per_stated for unit, per in OTHER_UNITS.get(column.unit, ())}
    fits = {
        unit: factor for unit, factor in factors.items() if factor < 1.0 and largest * factor <= column.plausible.high
    }
    return max(fits, key=lambda unit: fits[unit], default="")

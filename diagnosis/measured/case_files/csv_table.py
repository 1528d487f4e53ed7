"""Tables of measured files: columns with units, roles and plausible ranges."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from diagnosis.measured.channel import Role
from logs.units.plausible import PlausibleRange, beyond_scale, likely_unit
from symolo.core.errors import InputError, together
from symolo.core.files.text_file import LineFault, TextFile, read_text
from symolo.core.tables import table
from symolo.core.tables.table import CsvTable, NumberColumn, TableColumn, WordColumn

_LARGEST = 1e100
"""Largest number in a log. A reading far out of reach is an outlier and stays, but no square may overflow."""


@dataclass(frozen=True)
class MeasuredColumn:
    """A column of measured numbers."""

    name: str
    unit: str
    role: Role
    plausible: PlausibleRange
    """Range of the possible values."""
    decimals: int = 4
    """Digits after the point in files that we write; 0 means whole numbers, in files that we read as well."""
    may_be_empty: bool = True
    """Whether cells may be empty."""


CaseColumn = MeasuredColumn | WordColumn


def read_csv(path: Path, columns: Sequence[CaseColumn], *, may_lack_columns: bool = False) -> CsvTable:
    """Read a file whose first row names these columns, in any order.

    Args:
        path: The file.
        columns: What to read.
        may_lack_columns: Whether a column of numbers may be left out if its cells may be empty; it then reads as one
            with empty cells only.

    Raises:
        InputError: The file has faults, or a column is out of reach; the message names file, row and column of each.
    """
    text = read_text(path)
    header = table.cells_of(text.lines[0])
    optional = [
        column.name
        for column in columns
        if may_lack_columns and not isinstance(column, WordColumn) and column.may_be_empty
    ]
    wrong = table.header_faults(header, [column.name for column in columns], optional=optional)
    logged = [column for column in columns if header.count(column.name) == 1]
    if not logged:
        raise together([fault.error(path) for fault in wrong])
    places = [header.index(column.name) for column in logged]
    read = table.table_of(text, _strict(logged), places, first=1, is_log=True)
    faults = [fault.error(path) for fault in (*wrong, *_each_once(read.faults))]
    if not read.faults:
        faults += _reach_faults(read, logged)
    if faults:
        raise together(faults)
    absent = {column.name: np.full(len(read.row), np.nan) for column in columns if column not in logged}
    return replace(read, numbers={**read.numbers, **absent})


def _each_once(faults: Sequence[LineFault]) -> Iterator[LineFault]:
    """Yield the first of each series of faults that differ in row and value alone, with the number of the others."""
    alike: dict[str, list[LineFault]] = {}
    for fault in faults:
        alike.setdefault(fault.message.partition(": got ")[0] + fault.cure, []).append(fault)
    for first, *more in alike.values():
        others = f"{first.cure}; " if first.cure else ""
        others += f"so do {len(more)} more rows, the last one row {more[-1].line}" if more else ""
        yield replace(first, cure=others) if more else first


def table_of(
    text: TextFile,
    columns: Sequence[CaseColumn],
    places: Sequence[int],
    *,
    first: int,
    separator: str = ",",
    may_break: bool = False,
) -> CsvTable:
    """Return the table below a header; the arguments are those of `symolo.core.tables.table.table_of`.

    Raises:
        InputError: The table has a fault, or a column is out of reach.
    """
    strict = _strict(columns)
    read = table.table_of(text, strict, places, first=first, separator=separator, may_break=may_break, is_log=True)
    return _within_reach(read.checked(), columns)


def _strict(columns: Sequence[CaseColumn]) -> list[TableColumn]:
    return [
        column
        if isinstance(column, WordColumn)
        else NumberColumn(
            column.name,
            may_be_empty=column.may_be_empty,
            is_whole=column.decimals == 0,
            low=-_LARGEST,
            high=_LARGEST,
        )
        for column in columns
    ]


def _within_reach(read: CsvTable, columns: Sequence[CaseColumn]) -> CsvTable:
    """Return the table if no column of it is in another unit or out of reach."""
    if faults := _reach_faults(read, columns):
        raise together(faults)
    return read


def _reach_faults(read: CsvTable, columns: Sequence[CaseColumn]) -> list[InputError]:
    """Return columns in another unit, and inputs out of reach; a reading out of reach is an outlier and stays."""
    faults = []
    for column in columns:
        if isinstance(column, WordColumn):
            continue
        values = read.numbers[column.name]
        typical = beyond_scale(values, column.plausible)
        allowed = column.plausible.words(column.unit)
        beyond = np.flatnonzero(~column.plausible.holds(values)).tolist()
        if typical is not None:
            cure = likely_unit(typical, column.plausible, column.unit) or "check the column's unit"
            what = f"column {column.name}: most values are out of scale, typically {typical:.4g}"
            faults.append(InputError(what, where=str(read.path), allowed=allowed, cure=cure))
        elif beyond and column.role is Role.INPUT:
            cure = "repair or remove the row: inputs must be known"
            got = float(values[beyond[0]])
            where = read.where(beyond[0])
            faults.append(InputError(f"column {column.name}", where=where, got=got, allowed=allowed, cure=cure))
    return faults

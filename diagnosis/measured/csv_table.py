"""Tables of measured files: columns with units, roles and plausible ranges."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from diagnosis.measured.channel import Role
from diagnosis.measured.scale import Reach, beyond_scale, likely_unit
from symolo.core import table
from symolo.core.errors import InputError
from symolo.core.files.text_file import TextFile
from symolo.core.table import CsvTable, NumberColumn, TableColumn, WordColumn

_LARGEST = 1e100
"""Largest number in a log. A reading far out of reach is an outlier and stays, but no square may overflow."""


@dataclass(frozen=True)
class MeasuredColumn:
    """A column of measured numbers."""

    name: str
    unit: str
    role: Role
    reach: Reach
    """Possible values."""
    decimals: int = 4
    """Digits after the point in files that we write; 0 means whole numbers, in files that we read as well."""
    may_be_empty: bool = True


CaseColumn = MeasuredColumn | WordColumn


def read_csv(path: Path, columns: Sequence[CaseColumn]) -> CsvTable:
    """Read a file whose first row names these columns, in any order.

    Raises:
        InputError: The file has a fault, or a column is out of reach; the message names file, row and column.
    """
    return _within_reach(table.read_csv(path, _strict(columns)), columns)


def table_of(
    text: TextFile,
    columns: Sequence[CaseColumn],
    places: Sequence[int],
    *,
    first: int,
    separator: str = ",",
    may_break: bool = False,
) -> CsvTable:
    """Return the table below a header; the arguments are those of `symolo.core.table.table_of`.

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
    """Refuse a column in another unit, and an input out of reach; a reading out of reach is an outlier and stays."""
    for column in columns:
        if isinstance(column, WordColumn):
            continue
        values = read.numbers[column.name]
        typical = beyond_scale(values, column.reach)
        allowed = column.reach.words(column.unit)
        if typical is not None:
            cure = likely_unit(typical, column.reach, column.unit) or "check the column's unit"
            what = f"column {column.name}: most values are out of scale, in the middle {typical:.4g}"
            raise InputError(what, where=str(read.path), allowed=allowed, cure=cure)
        beyond = np.flatnonzero(~column.reach.holds(values)).tolist()
        if beyond and column.role is Role.INPUT:
            cure = "repair or remove the row: inputs must be known"
            got = float(values[beyond[0]])
            raise InputError(f"column {column.name}", where=read.where(beyond[0]), got=got, allowed=allowed, cure=cure)
    return read

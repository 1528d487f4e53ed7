"""The one reader of CSV tables: known columns, finite numbers, and each fault with its row and column.

Reading does not stop at a fault, so that a verification can list them, but it does after `MAX_FAULTS`, for a message of
each cell of a large file would need far more memory than the file; `CsvTable.checked` raises the first.
"""

import re
import sys
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite, nan
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array
from symolo.core.errors import InputError, nearest, shown
from symolo.core.files.text_file import LineFault, TextFile
from symolo.core.progress import plural

MAX_FAULTS = 1000
"""Faults of a table after which its rows are not read any further, and largest number of notes on broken rows."""
NO_NUMBER = re.compile(r"[-+]?(nan|inf(inity)?)|null|none|na|n/a|-|#n/a", re.IGNORECASE)
"""Words by which loggers mark a sample that is missing."""
_SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs", " ": "spaces"}
_DECIMAL_COMMA = re.compile(r"[-+]?[0-9]+,[0-9]+")


@dataclass(frozen=True)
class NumberColumn:
    """A column of finite numbers."""

    name: str
    may_be_empty: bool = False
    """Whether cells may be empty, which reads as NaN."""
    is_whole: bool = False
    low: float = -inf
    high: float = inf
    """Smallest and largest allowed value."""


@dataclass(frozen=True)
class WordColumn:
    """A column of words."""

    name: str
    allowed: tuple[str, ...] = ()
    """Words that may stand in it; empty for any word."""
    may_be_empty: bool = False


TableColumn = NumberColumn | WordColumn


@dataclass(frozen=True)
class CsvTable:
    """The content of a table."""

    path: Path
    row: NDArray[np.int64]
    """(N,), number of each row in the file, from 1 with the header."""
    numbers: Mapping[str, Array]
    """(N,) for each column of numbers, NaN where a cell is empty."""
    words: Mapping[str, tuple[str, ...]]
    """(N,) for each column of words."""
    notes: tuple[str, ...]
    """Unusual things that were read all the same, in one sentence each."""
    faults: tuple[LineFault, ...] = ()

    def where(self, i: int) -> str:
        """Return the place of a row for a message."""
        return f"{self.path}: row {self.row[i]}"

    def checked(self) -> "CsvTable":
        """Return the table.

        Raises:
            InputError: It has a fault.
        """
        if self.faults:
            raise self.faults[0].error(self.path)
        return self


def cells_of(line: str, separator: str = ",") -> list[str]:
    """Return the cells of a line without the spaces around them."""
    return [cell.strip() for cell in line.split(separator)]


def check_header(header: Sequence[str], names: Sequence[str], path: Path) -> None:
    """Refuse a header that does not have exactly these names, in any order.

    Raises:
        InputError: A column is unknown, missing or there twice, or row 1 is no header.
    """
    if fault := header_fault(header, names):
        raise fault.error(path)


def header_fault(
    header: Sequence[str],
    names: Sequence[str],
    separator: str = ",",
    optional: Collection[str] = (),
    *,
    is_ordered: bool = False,
) -> LineFault | None:
    """Return what is wrong with a header that must have exactly these names, of which some are `optional`.

    `is_ordered` means in this order.
    """
    if faults := header_faults(header, names, separator, optional):
        return faults[0]
    if is_ordered and list(header) != [name for name in names if name in header]:
        return LineFault(1, f"columns in another order; allowed: {separator.join(names)}", "put them in this order")
    return None


def header_faults(
    header: Sequence[str], names: Sequence[str], separator: str = ",", optional: Collection[str] = ()
) -> list[LineFault]:
    """Return everything that is wrong with a header that must have these names, of which some are `optional`."""
    allowed = f"allowed: {separator.join(names)}"
    if len(header) == 1 and len(names) > 1:
        other = next((mark for mark in _SEPARATORS if mark != separator and mark in header[0]), "")
        cure = f"separate columns with {_SEPARATORS[separator]}, not with {other!r}" if other else "add a header line"
        return [LineFault(1, f"one column: got {shown(header[0])}, {allowed}", cure)]
    if all(isfinite(number_of(name)) for name in header):
        return [LineFault(1, f"no header: got {shown(separator.join(header))}, {allowed}")]
    faults = [_unknown_column(name, header, names, allowed) for name in dict.fromkeys(header) if name not in names]
    faults += [
        LineFault(1, f"column {name} is there twice", "keep one of them") for name in names if header.count(name) > 1
    ]
    missing = [name for name in names if name not in header and name not in optional]
    cure = "add it, with empty cells if it was not logged"
    return faults + [LineFault(1, f"column {name} is missing: got {shown(list(header))}", cure) for name in missing]


def _unknown_column(name: str, header: Sequence[str], names: Sequence[str], allowed: str) -> LineFault:
    missing = [column for column in names if column not in header]
    close = nearest(name, missing) or nearest(name, names)
    cure = "remove it"
    if close and "_" in name and close.rpartition("_")[0] == name.rpartition("_")[0]:
        cure = f"convert it to {close.rpartition('_')[2]} and rename it"
    elif close in missing:
        cure = "rename it"
    hint = f"; did you mean {close}" if close else ""
    return LineFault(1, f"column {name[:40]} is not known; {allowed}{hint}", cure)


def table_of(
    text: TextFile,
    columns: Sequence[TableColumn],
    places: Sequence[int],
    *,
    first: int,
    separator: str = ",",
    may_break: bool = False,
    is_log: bool = False,
) -> CsvTable:
    """Return the table below a header, with all of its faults.

    Args:
        text: The file.
        columns: Columns to read.
        places: Index of each column among the cells of a row.
        first: Index of the first line below the header.
        separator: Character between cells.
        may_break: Whether a row with too few cells is left out with a note: logs of a serial line have broken rows.
        is_log: Whether each row may end with one more separator, and the last row may lack its line end.
    """
    width = len(text.lines[first - 1].rstrip(separator).split(separator)) if first else max(places) + 1
    reader = _RowReader(text, columns, places, width, may_break=may_break, is_log=is_log)
    for row, line in enumerate(text.lines[first:], first + 1):
        if len(reader.faults) >= MAX_FAULTS:
            what = f"{len(reader.faults)} faults up to here; the rows below are not read"
            reader.faults.append(LineFault(row - 1, what))
            break
        reader.read(row, line.split(separator))
    return reader.table()


class _RowReader:
    """Reads rows of a table one by one, and collects their values, notes and faults; see `table_of`."""

    def __init__(
        self,
        text: TextFile,
        columns: Sequence[TableColumn],
        places: Sequence[int],
        width: int,
        *,
        may_break: bool,
        is_log: bool,
    ) -> None:
        self._text, self._width, self._may_break, self._is_log = text, width, may_break, is_log
        both = list(zip(columns, places, strict=True))
        self._numbers = [(column, place) for column, place in both if isinstance(column, NumberColumn)]
        self._words = [(column, place) for column, place in both if isinstance(column, WordColumn)]
        self._rows: list[int] = []
        """Numbers of the rows in the file."""
        self._values: list[list[float]] = []
        self._texts: list[list[str]] = []
        self._notes = list(text.notes)
        self.faults: list[LineFault] = []

    def read(self, row: int, cells: list[str]) -> None:
        """Read the cells of a row, whose number in the file is `row`."""
        if self._may_break and len(cells) < self._width:
            note = f"{self._text.path.name}: row {row} is broken and left out"
            self._notes += [note] if len(self._notes) < MAX_FAULTS else []
            return
        if self._is_log and len(cells) == self._width + 1 and not cells[-1].strip():
            cells.pop()
        if len(cells) != self._width:
            self.faults.append(_width_fault(row, len(cells), self._width))
            return
        try:
            if self._is_log and row == len(self._text.lines) and not self._text.is_whole:
                self._notes.append(_loose_end(cells, self._numbers, self._text))
        except InputError as error:
            self.faults.append(LineFault(row, str(error)))
            return
        try:
            self._values.append([_number(cells[place], column) for column, place in self._numbers])
            self._texts.append([_word(cells[place].strip(), column) for column, place in self._words])
        except InputError:
            self.faults += [LineFault(row, str(fault)) for fault in _cell_faults(cells, self._numbers, self._words)]
        self._rows.append(row)

    def table(self) -> CsvTable:
        """Return the table of all rows; it has no rows if it has faults."""
        if not self._rows and not self.faults:
            self.faults.append(LineFault(0, "has no rows below the header", "log again, or leave it out"))
        rows, values, texts = ([], [], []) if self.faults else (self._rows, self._values, self._texts)
        number_array = np.array(values, np.float64).reshape(len(values), len(self._numbers))
        return CsvTable(
            self._text.path,
            np.array(rows, np.int64),
            {column.name: number_array[:, k].copy() for k, (column, _) in enumerate(self._numbers)},
            {column.name: tuple(row[k] for row in texts) for k, (column, _) in enumerate(self._words)},
            tuple(self._notes),
            tuple(self.faults),
        )


def _cell_faults(
    cells: Sequence[str], numbers: Sequence[tuple[NumberColumn, int]], words: Sequence[tuple[WordColumn, int]]
) -> Iterator[InputError]:
    """Yield the fault of each cell of a row that has one."""
    for column, place in (*numbers, *words):
        try:
            if isinstance(column, NumberColumn):
                _number(cells[place], column)
            else:
                _word(cells[place].strip(), column)
        except InputError as error:
            yield error


def _width_fault(row: int, count: int, width: int) -> LineFault:
    cut_off, surplus = "the row is cut off: remove it", "remove the surplus cells; decimals take a point"
    return LineFault(row, f"{plural(count, 'column')}; allowed: {width}", cut_off if count < width else surplus)


def _loose_end(cells: list[str], numbers: Sequence[tuple[NumberColumn, int]], text: TextFile) -> str:
    """Empty the last cell of a file without a last line end, because nobody knows how it goes on, and return a note."""
    last = len(cells) - 1
    for column, place in numbers:
        if place == last and column.may_be_empty:
            cells[last] = ""
            return (
                f"{text.path.name} has no line end after its last row: the cell in column {column.name} may be cut "
                "off and is taken for missing; add a line end if it is whole"
            )
    what = "has no line end: the file may be cut off"
    raise InputError(what, cure="add a line end if the row is whole, or remove the row")


def number_of(text: str) -> float:
    """Return a number as written in plain digits; NaN for anything else."""
    try:
        return float(text) if text.isascii() and "_" not in text else nan
    except ValueError:
        return nan


def number(text: str, column: str, where: str, allowed: str = "a number") -> float:
    """Return a finite number from a cell of this column.

    Raises:
        InputError: It is none.
    """
    value = number_of(text)
    if not isfinite(value):
        text = text.strip()
        cure = "leave the cell empty where nothing was measured" if NO_NUMBER.fullmatch(text) else ""
        cure = "write decimals with a point" if _DECIMAL_COMMA.fullmatch(text) else cure
        raise InputError(f"column {column}", where=where, got=text, allowed=allowed, cure=cure)
    return value


def _number(cell: str, column: NumberColumn) -> float:
    if column.may_be_empty and not cell.strip():
        return nan
    value = number(cell, column.name, "", "a number or an empty cell" if column.may_be_empty else "a number")
    if not column.low <= value <= column.high:
        raise InputError(f"column {column.name}", got=cell.strip(), allowed=f"{column.low:g} to {column.high:g}")
    if column.is_whole and not value.is_integer():
        raise InputError(f"column {column.name}", got=cell.strip(), allowed="a whole number")
    return value


def _word(cell: str, column: WordColumn) -> str:
    """Return the column's own copy of the word where it has one, so that a long file holds each of them once."""
    for word in column.allowed:
        if word == cell:
            return word
    if column.allowed:
        close = nearest(cell, column.allowed)
        raise InputError(
            f"column {column.name}", got=cell, allowed=f"one of {', '.join(column.allowed)}", nearest=close
        )
    if not cell and not column.may_be_empty:
        raise InputError(f"column {column.name}", got=cell, allowed="a word")
    return sys.intern(cell)

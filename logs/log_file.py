"""A log of any origin: a header line, below comments if there are any, and below it columns of numbers or words."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from pathlib import Path

import numpy as np

from logs.clock_times import CLOCK_TIMES, seconds_of
from logs.log_lines import SEPARATORS, cells_in, with_plain_numbers, with_tabs
from logs.recognition import MAX_TITLES
from logs.units.names import NO_UNIT, taken_apart, unit_of_cell, with_unit
from symolo.core.arrays import Array
from symolo.core.errors import FaultList, InputError
from symolo.core.files.text_file import read_text
from symolo.core.progress import plural
from symolo.core.tables.table import NO_NUMBER, number_of

MAX_HEADER_ROWS = 2
"""Most rows of words below the header, such as units and symbols."""
MAX_NAME_LENGTH = 500
"""Longest name of a column, in characters; messages contain it."""
MIN_UNITS = 2
"""Units that a row of units has for each other word in it."""


@dataclass(frozen=True)
class LogFile:
    """The cells of a log, as text, with the place of each row in the file."""

    path: Path
    columns: Mapping[str, tuple[str, ...]]
    """(N,) cells of each column."""
    has_decimal_commas: bool
    clocks: frozenset[str] = frozenset()
    """Columns that the file has as times of day or dates, here as seconds since the first one."""
    notes: tuple[str, ...] = ()
    """Unusual parts of the file that were read all the same, in one sentence each."""
    header_row: int = 1
    """Number of the line with the names of the columns, from 1; 0 if the user named them."""
    first_row: int = 2
    """Number of the line with the first cells below the header, from 1."""

    @property
    def header_where(self) -> str:
        """Place of the names of the columns for messages."""
        return f"{self.path}: row {self.header_row}" if self.header_row else f"{self.path}: names of the columns"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns that the user gave, for a file without a header; none if it has one."""
        return () if self.header_row else tuple(self.columns)

    @property
    def clocks_last(self) -> list[str]:
        """Names of the columns, with times of day behind the others: these often have whole seconds only."""
        return sorted(self.columns, key=self.clocks.__contains__)

    def where(self, row: int) -> str:
        """Return the place of a row of the columns, from 0, for messages."""
        return f"{self.path}: {self.row(row)}"

    def row(self, row: int) -> str:
        """Return the name of a row of the columns, from 0, as it counts in the file."""
        return f"row {self.first_row + row}"

    @property
    def rows(self) -> int:
        return len(next(iter(self.columns.values())))

    def numbers(self, name: str) -> Array:
        """Return a column as numbers (N,), NaN where a sample is missing.

        Raises:
            InputError: A cell is no number; the message names its row.
        """
        values = self._values(name)
        wrong = np.flatnonzero(np.isinf(values)).tolist()
        if wrong:
            more = f"; rows of this column with such a cell: {len(wrong)}" if len(wrong) > 1 else ""
            cure = f"leave the cell empty where nothing was measured{more}"
            where, got = self.where(wrong[0]), self.columns[name][wrong[0]]
            raise InputError(f"column {name}", where=where, got=got, allowed="a number or an empty cell", cure=cure)
        return values

    def times(self, name: str) -> Array:
        """Return a column of times (N,), each of which is a number.

        Raises:
            InputError: A cell is no number, or empty; the message names its row.
        """
        values = self._values(name)
        wrong = np.flatnonzero(~np.isfinite(values)).tolist()
        if wrong:
            more = f"; rows without a time: {len(wrong)}" if len(wrong) > 1 else ""
            where, got = self.where(wrong[0]), self.columns[name][wrong[0]]
            cure = f"remove each row whose time is not known{more}"
            if len(wrong) == len(values):
                cure = f"write the times in such a form; no row of this column has one: {len(wrong)} rows"
            allowed = f"a number, since it is a time; or in all rows {CLOCK_TIMES}"
            raise InputError(f"column {name}", where=where, got=got, allowed=allowed, cure=cure)
        return values

    def signs(self, name: str, backwards: Sequence[str | float]) -> Array:
        """Return -1 for each cell (N,) of a column that has one of these words or numbers, and 1 for the others."""
        texts = {value.lower() for value in backwards if isinstance(value, str)}
        numbers = {value for value in backwards if not isinstance(value, str)}
        cells = self.columns[name]
        return np.array([-1.0 if cell.lower() in texts or self._number(cell) in numbers else 1.0 for cell in cells])

    @cached_property
    def _read_columns(self) -> dict[str, Array]:
        """Numbers of the columns that were read so far: proposals, quantities and notes read the same ones."""
        return {}

    def _values(self, name: str) -> Array:
        """Return the numbers (N,) of a column, NaN where one is missing and infinity where a cell is no number."""
        if name not in self._read_columns:
            values = np.array([self._number(cell) for cell in self.columns[name]])
            values.flags.writeable = False
            self._read_columns[name] = values
        return self._read_columns[name]

    def _number(self, cell: str) -> float:
        """Return the number in a cell; NaN if it is missing, and infinity if it is anything else."""
        if not cell or NO_NUMBER.fullmatch(cell):
            return np.nan
        value = number_of(cell.replace(",", ".") if self.has_decimal_commas else cell)
        return value if isfinite(value) else np.inf


def read_log(path: Path, names: Sequence[str] = ()) -> LogFile:
    """Read a log whose cells are separated by commas, semicolons or tabs, whichever the header has most of, or spaces.

    Decimals may have a comma, in a file with commas as separators only in quotes. Quotes around a cell are left out, as
    are comments above the header, empty lines at the end and a last row that is cut off. A row of units below the
    header becomes a part of the names: `x` with `cm` below it is the column `x [cm]`. Times of day and dates become
    seconds.

    Args:
        path: The file.
        names: Names of the columns of a file without a header; by default its header has them.

    Raises:
        InputError: The file is no such table; the message names every row that has too few or too many cells.
    """
    text = read_text(path, of_any_encoding=True)
    lines, notes = with_tabs(text.lines), list(text.notes)
    while len(lines) > 1 and not lines[-1].strip():
        lines.pop()
    above = _first_row(lines) if names else _comments(lines)
    above += 0 if names else _titles(lines[above:])
    if above:
        notes.append(f"{path.name}: left out above the {'rows' if names else 'header'}: {plural(above, 'row')}")
    first_row = above + (1 if names else 2)
    separator, header = _header_of(lines[above].lstrip("# "), names, f"{path}: row {above + 1}")
    below = [lines[first_row - 1].lstrip("# "), *lines[first_row:]] if len(lines) >= first_row else []
    rows = [cells_in(line, separator) for line in below]
    header, header_notes = _with_header_rows(header, rows, path.name, first_row)
    first_row, rows, notes = first_row + len(header_notes), rows[len(header_notes) :], notes + header_notes
    rows = [row[:-1] if len(row) == len(header) + 1 and not row[-1] else row for row in rows]
    if len(rows) > 1 and (len(rows[-1]) < len(header) or not text.is_whole):
        rows.pop()
        notes.append(f"{path.name}: the last row is cut off or has no line end, and is left out")
    _check_rows(rows, header, first_row, path, above + 1)
    if not rows:
        raise InputError("has no rows below the header", where=str(path))
    has_decimal_commas = separator != ","
    if separator == ",":
        rows, has_decimal_commas = with_plain_numbers(rows, str(path))
    columns = {name: tuple(row[i] for row in rows) for i, name in enumerate(header) if name}
    clocks = _clocks(columns)
    notes += [
        f"{path.name}: column {name} has times of day, and is read as seconds since its first one" for name in clocks
    ]
    return LogFile(
        path,
        columns | clocks,
        has_decimal_commas=has_decimal_commas,
        clocks=frozenset(clocks),
        notes=tuple(notes),
        header_row=0 if names else above + 1,
        first_row=first_row,
    )


def _header_of(line: str, names: Sequence[str], where: str) -> tuple[str, list[str]]:
    """Return the separator and the names of the columns, which the line has if `names` is empty.

    Raises:
        InputError: The line is no header, or does not have as many cells as there are names.
    """
    if not names:
        separator = _separator(line)
        header = cells_in(line, separator)
    else:
        separator, header = _separator_for(names, line), list(names)
        _check_names(names, cells_in(line, separator), where)
    _check_header(header, where)
    return separator, header


def _with_header_rows(
    header: list[str], rows: Sequence[Sequence[str]], file: str, first_row: int
) -> tuple[list[str], list[str]]:
    """Return the names of the columns with the units below them, and a note for each row that belongs to the header."""
    words, notes = _header_rows(header, rows), []
    for number, row in enumerate(words, first_row):
        if _are_units(row, rows[len(words)]):
            header = [with_unit(name, unit) for name, unit in zip(header, row, strict=True)]
            notes.append(f"{file}: row {number} has the units of the columns")
        else:
            notes.append(f"{file}: row {number} has words only and is left out")
    return header, notes


def _clocks(columns: Mapping[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
    """Return the columns with times of day or dates, as seconds; a name with a unit is that of numbers."""
    seconds = {name: seconds_of(cells) for name, cells in columns.items() if taken_apart(name).unit in {"", "s"}}
    return {name: cells for name, cells in seconds.items() if cells}


def _check_rows(
    rows: Sequence[Sequence[str]], header: Sequence[str], first_row: int, path: Path, header_row: int
) -> None:
    """Raise InputError if a row has another number of cells than the header."""
    wrong = [number for number, row in enumerate(rows, first_row) if len(row) != len(header)]
    if not wrong:
        return
    count = f"; rows with a wrong number of cells: {len(wrong)}, the last one is row {wrong[-1]}"
    cure = f"repair or remove the row{count if len(wrong) > 1 else ''}"
    if len(header) == 1 and len(wrong) == len(rows):
        cure = f"row {header_row} is no header with the names of the columns: remove it, or begin it with #"
    what = f"{len(rows[wrong[0] - first_row])} cells under a header of {len(header)}"
    raise InputError(what, where=f"{path}: row {wrong[0]}", cure=cure)


def _separator(header: str) -> str:
    return max(SEPARATORS, key=header.count)


def _separator_for(names: Sequence[str], row: str) -> str:
    """Return the separator of a first row of values, in which commas may be decimal ones, by the number of names."""
    fitting = [each for each in reversed(SEPARATORS) if row.count(each) in {len(names) - 1, len(names)}]
    return next((each for each in fitting if each in row), _separator(row))


def _titles(lines: Sequence[str]) -> int:
    """Return the number of lines above the header that have another number of cells than it, which all rows fit."""
    for number in range(1, min(MAX_TITLES, len(lines) - 2) + 1):
        header, separator = lines[number], _separator(lines[number])
        if not header.strip() or any(map(_is_number, _pieces(header))):
            continue
        titles = [len(cells_in(line.rstrip(separator), separator)) for line in lines[:number] if line.strip()]
        count = len(cells_in(header, separator))
        is_header = not {count, len(cells_in(header.rstrip(separator), separator))} & {*titles}
        if titles and is_header and _fit(lines[number + 1 :], separator, count):
            return number
    return 0


def _fit(lines: Sequence[str], separator: str, count: int) -> bool:
    """Return whether all lines have a number of cells, or a separator behind these; the last one may be cut off."""
    for line in filter(str.strip, lines):
        cells = cells_in(line, separator)
        is_cut_off = line is lines[-1] and len(lines) > 1 and len(cells) < count
        if len(cells) != count and not (len(cells) == count + 1 and not cells[-1]) and not is_cut_off:
            return False
    return True


def _header_rows(header: Sequence[str], rows: Sequence[Sequence[str]]) -> Sequence[Sequence[str]]:
    """Return the rows below the header that belong to it: that of the units, and others of words above the values."""
    for number in range(1, min(MAX_HEADER_ROWS, len(rows) - 1) + 1):
        words = rows[:number]
        if any(
            len(row) != len(header) or any(_is_number(cell) and cell not in NO_UNIT for cell in row) for row in words
        ):
            break
        if _are_values(rows[number]) and any(_are_units(row, rows[number]) for row in words):
            return words
    return ()


def _first_row(lines: Sequence[str]) -> int:
    """Return the index of the first line that neither is empty nor begins with #; 0 if there is none."""
    return next((k for k, line in enumerate(lines) if line.strip() and not line.startswith("#")), 0)


def _comments(lines: Sequence[str]) -> int:
    """Return the number of lines above the header: empty ones, and those that begin with #.

    The last of these is the header itself if the line below it is a row of values, or has the units of the header above
    it in such a case.
    """
    below = _first_row(lines)
    if below == 0 or not lines[below - 1].startswith("#") or not _are_values(_pieces(lines[below])):
        return below
    first = _pieces(lines[below])
    has_units = below > 1 and lines[below - 2].startswith("#") and _are_units(_pieces(lines[below - 1]), first)
    return below - 2 if has_units else below - 1


def _pieces(line: str) -> list[str]:
    """Return the cells of a line, whatever separates them."""
    return [cell.strip().strip('"') for cell in re.split(r"[,;\t]", line.lstrip("# "))]


def _are_values(cells: Sequence[str]) -> bool:
    """Return whether a row has a number, or nothing but marks of missing samples."""
    return any(_is_number(cell) for cell in cells) or all(not cell or NO_NUMBER.fullmatch(cell) for cell in cells)


def _is_number(cell: str) -> bool:
    return isfinite(number_of(cell.replace(",", ".")))


def _are_units(cells: Sequence[str], below: Sequence[str]) -> bool:
    """Return whether a row has units, few other words and no numbers, and the row below it no word under a unit."""
    units = [bool(unit_of_cell(cell)) for cell in cells]
    others = [not is_unit and cell not in {"", *NO_UNIT} for is_unit, cell in zip(units, cells, strict=True)]
    words = [bool(cell) and not _is_number(cell) and not NO_NUMBER.fullmatch(cell) for cell in below]
    return (
        any(units)
        and MIN_UNITS * sum(others) <= sum(units)
        and not any(map(_is_number, (cell for cell, is_other in zip(cells, others, strict=True) if is_other)))
        and not any(is_unit and is_word for is_unit, is_word in zip(units, words, strict=False))
    )


def _check_names(names: Sequence[str], cells: Sequence[str], where: str) -> None:
    """Refuse names of columns that do not fit the first row (cells) of a file.

    Raises:
        InputError: They are too few or too many, one is empty, or the row is a header.
    """
    if "" in names:
        cure = "name every column, also one that is not used"
        raise InputError(f"name {[*names].index('') + 1} is empty", where=where, cure=cure)
    if cells[-1] == "" and len(cells) > len(names):  # a separator at the end of each row
        cells = cells[:-1]
    if len(names) != len(cells):
        allowed = f"{len(cells)}, one for each column"
        raise InputError(f"{len(names)} names for {len(cells)} columns", where=where, allowed=allowed)
    if not _are_values(cells):
        raise InputError(
            "the row is a header", where=where, got=[*cells], cure="leave the names out, and rename columns"
        )


def _check_header(header: Sequence[str], where: str) -> None:
    faults = FaultList()
    if all(isfinite(number_of(name.replace(",", "."))) for name in header):
        cure = (
            "add a line with the names of the columns above the numbers, such as t_s,x_m,y_m,theta_rad, or give them "
            "with --names of `symolo case init`, or as header: [t_s, ...] in a mapping file"
        )
        raise InputError("no header", where=where, cure=cure)
    for number, name in enumerate(header, 1):
        if len(name) > MAX_NAME_LENGTH:
            what, allowed = f"the name of column {number} has {len(name)} characters", f"at most {MAX_NAME_LENGTH}"
            cure = "shorten it, or separate the columns with commas, semicolons or tabs"
            raise InputError(what, where=where, allowed=allowed, cure=cure)
    for name in dict.fromkeys(header):
        if name and header.count(name) > 1:
            with faults.noted():
                raise InputError(f"column {name} is there twice", where=where, cure="rename or remove one of them")
    faults.check()

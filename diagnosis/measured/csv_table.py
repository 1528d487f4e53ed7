"""A table of a measured CSV file, read strictly: known columns, finite numbers, empty cells where they may be."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, nan
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from diagnosis.measured.channel import Role
from diagnosis.measured.scale import Reach, beyond_scale, likely_unit
from diagnosis.measured.text_file import TextFile, number, read_text
from symolo.core.arrays import Array
from symolo.core.errors import InputError, nearest


@dataclass(frozen=True)
class Column:
    """What a column of a file holds."""

    name: str
    unit: str
    role: Role
    reach: Reach
    decimals: int = 4
    """In files that we write; 0 is a whole number, in files that we read too."""
    may_be_empty: bool = True


@dataclass(frozen=True)
class WordColumn:
    """A column of words."""

    name: str
    allowed: tuple[str, ...] = ()
    """None given: any word."""
    may_be_empty: bool = False


@dataclass(frozen=True)
class Table:
    path: Path
    row: NDArray[np.int64]
    """(N,), number of each row in the file, from 1 with the header."""
    numbers: Mapping[str, Array]
    """(N,) by column, NaN where a cell is empty."""
    words: Mapping[str, tuple[str, ...]]
    notes: tuple[str, ...]

    def where(self, i: int) -> str:
        return f"{self.path}: row {self.row[i]}"


AnyColumn = Column | WordColumn


def read_csv(path: Path, columns: Sequence[AnyColumn]) -> Table:
    """A file whose first row names these columns, in any order.

    Raises:
        InputError: The first thing that is not so; the text names file, row and column.
    """
    text = read_text(path)
    header = [name.strip() for name in text.lines[0].split(",")]
    check_header(header, [column.name for column in columns], path)
    return table_of(text, columns, [header.index(column.name) for column in columns], first=1)


def check_header(header: Sequence[str], wanted: Sequence[str], path: Path) -> None:
    """Refuse a header that does not have exactly the names wanted.

    Raises:
        InputError: A column is unknown, missing or there twice, or row 1 is no header.
    """
    where = f"{path}: row 1"
    if len(header) == 1 and len(wanted) > 1:
        other = next((mark for mark in (";", "\t") if mark in header[0]), "")
        cure = f"separate columns with commas, not with {other!r}" if other else "put a header line there"
        raise InputError("one column", where=where, got=header[0], allowed=",".join(wanted), cure=cure)
    if all(_is_number(name) for name in header):
        raise InputError("no header", where=where, got=",".join(header), allowed=",".join(wanted))
    for name in header:
        if name not in wanted:
            raise _unknown(name, header, wanted, where)
    for name in wanted:
        if header.count(name) > 1:
            raise InputError(f"column {name} is there twice", where=where, cure="keep one of them")
    for name in wanted:
        if name not in header:
            cure = "add it, with empty cells if it was not logged"
            raise InputError(f"column {name} is missing", where=where, got=list(header), cure=cure)


def _unknown(name: str, header: Sequence[str], wanted: Sequence[str], where: str) -> InputError:
    missing = [column for column in wanted if column not in header]
    close = nearest(name, missing) or nearest(name, wanted)
    cure = "remove it"
    if close and "_" in name and close.rpartition("_")[0] == name.rpartition("_")[0]:
        cure = f"convert it to {close.rpartition('_')[2]} and rename it"
    elif close in missing:
        cure = "rename it"
    return InputError(f"column {name} is not known", where=where, allowed=",".join(wanted), nearest=close, cure=cure)


def _is_number(text: str) -> bool:
    try:
        return isfinite(float(text))
    except ValueError:
        return False


def table_of(
    text: TextFile,
    columns: Sequence[AnyColumn],
    places: Sequence[int],
    *,
    first: int,
    separator: str = ",",
    may_break: bool = False,
) -> Table:
    """The table below a header.

    Args:
        text: The file.
        columns: What to read.
        places: Index of each column among the cells of a row.
        first: Index of the first line below the header.
        separator: Between cells; each row may end with one more of it.
        may_break: Whether a row with too few cells is left out, and said, instead of refused: in the logs of a serial
            line some are broken.

    Raises:
        InputError: The first cell or row that is not as it should be.
    """
    width = len(text.lines[first - 1].rstrip(separator).split(separator)) if first else max(places) + 1
    of_numbers = [(c, place) for c, place in zip(columns, places, strict=True) if isinstance(c, Column)]
    of_words = [(c, place) for c, place in zip(columns, places, strict=True) if isinstance(c, WordColumn)]
    values = np.full((len(text.lines) - first, len(of_numbers)), nan)
    words: list[list[str]] = [[] for _ in of_words]
    kept, notes = [], list(text.notes)
    for row, line in enumerate(text.lines[first:], first + 1):
        if may_break and line.count(separator) + 1 < width:
            notes.append(f"{text.path.name}: row {row} is broken and left out")
            continue
        cells = _cells(line, width, text.path, row, separator)
        if row == len(text.lines) and not text.is_whole:
            notes.append(_loose_end(cells, columns, places, text))
        for k, (column, place) in enumerate(of_numbers):
            values[len(kept), k] = _value(cells[place], column, text.path, row)
        for found, (column, place) in zip(words, of_words, strict=True):
            found.append(_word(cells[place].strip(), column, text.path, row))
        kept.append(row)
    if not kept:
        raise InputError("has no rows below the header", where=str(text.path), cure="log again, or leave it out")
    numbers = {column.name: values[: len(kept), k].copy() for k, (column, _) in enumerate(of_numbers)}
    for column, _ in of_numbers:
        _check_column(numbers[column.name], column, text.path, kept)
    labels = {column.name: tuple(found) for found, (column, _) in zip(words, of_words, strict=True)}
    return Table(text.path, np.array(kept), numbers, labels, tuple(notes))


def _cells(line: str, width: int, path: Path, row: int, separator: str) -> list[str]:
    cells = line.split(separator)
    if len(cells) == width + 1 and not cells[-1].strip():
        cells.pop()
    if len(cells) != width:
        cure = (
            "the row is cut off: remove it" if len(cells) < width else "remove what is too much; decimals take a point"
        )
        raise InputError(f"{len(cells)} columns", where=f"{path}: row {row}", allowed=f"{width}", cure=cure)
    return cells


def _loose_end(cells: list[str], columns: Sequence[AnyColumn], places: Sequence[int], text: TextFile) -> str:
    """Take the last cell of a file without a last line end for missing, since nobody knows how it goes on."""
    last = len(cells) - 1
    for column, place in zip(columns, places, strict=True):
        if place == last and isinstance(column, Column) and column.may_be_empty:
            cells[last] = ""
            return (
                f"{text.path.name} has no line end after its last row: the cell in column {column.name} may be cut "
                "off and is taken for missing; add a line end if it is whole"
            )
    raise InputError(
        "has no line end: the file may be cut off",
        where=f"{text.path}: row {len(text.lines)}",
        cure="add a line end if the row is whole, or remove the row",
    )


def _value(cell: str, column: Column, path: Path, row: int) -> float:
    if not column.may_be_empty:
        return number(cell, path, row, column.name)
    return number(cell, path, row, column.name, "a number or an empty cell") if cell.strip() else nan


def _word(cell: str, column: WordColumn, path: Path, row: int) -> str:
    """The column's own word where it has some, so that a long file holds each of them once."""
    for word in column.allowed:
        if word == cell:
            return word
    if column.allowed:
        allowed, close = f"one of {', '.join(column.allowed)}", nearest(cell, column.allowed)
        raise InputError(f"column {column.name}", where=f"{path}: row {row}", got=cell, allowed=allowed, nearest=close)
    if not cell and not column.may_be_empty:
        raise InputError(f"column {column.name}", where=f"{path}: row {row}", got=cell, allowed="a word")
    return sys.intern(cell)


def _check_column(values: Array, column: Column, path: Path, row: Sequence[int]) -> None:
    """Refuse a column in another unit, an input out of reach, and fractions among whole numbers."""
    typical = beyond_scale(values, column.reach)
    allowed = column.reach.words(column.unit)
    if typical is not None:
        cure = likely_unit(typical, column.reach, column.unit) or "check the column's unit"
        what = f"column {column.name}: most values are out of scale, in the middle {typical:.4g}"
        raise InputError(what, where=str(path), allowed=allowed, cure=cure)
    beyond = np.flatnonzero(~column.reach.holds(values)).tolist()
    if beyond and column.role is Role.INPUT:
        cure = "mend or remove the row: what was set must be known"
        where, got = f"{path}: row {row[beyond[0]]}", float(values[beyond[0]])
        raise InputError(f"column {column.name}", where=where, got=got, allowed=allowed, cure=cure)
    fractions = np.flatnonzero(values % 1.0 > 0.0).tolist() if column.decimals == 0 else []
    if fractions:
        where, got = f"{path}: row {row[fractions[0]]}", float(values[fractions[0]])
        raise InputError(f"column {column.name}", where=where, got=got, allowed="a whole number")

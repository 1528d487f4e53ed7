"""A table of a measured CSV file, read strictly: known columns, finite numbers, empty cells where they may be."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, nan
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from configs.errors import InputError, nearest
from diagnosis.measured.channel import Array, Role
from diagnosis.measured.scale import Reach, beyond_scale, likely_unit
from diagnosis.measured.text_file import TextFile, number, read_text


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
    numbered = list(enumerate(text.lines[first:], first + 1))
    whole = [(i, line) for i, line in numbered if not may_break or line.count(separator) + 1 >= width]
    kept = [i for i, _ in whole]
    rows = [_cells(line, width, text.path, i, separator) for i, line in whole]
    if not rows:
        raise InputError("has no rows below the header", where=str(text.path), cure="log again, or leave it out")
    broken = sorted({i for i, _ in numbered} - set(kept))
    notes = [*text.notes, *(f"{text.path.name}: row {i} is broken and left out" for i in broken)]
    if not text.is_whole and kept[-1] == numbered[-1][0]:
        notes.append(_loose_end(rows, columns, places, text))
    found = {
        column.name: _numbers([cells[place] for cells in rows], column, text.path, kept)
        for column, place in zip(columns, places, strict=True)
        if isinstance(column, Column)
    }
    words = {
        column.name: _words([cells[place].strip() for cells in rows], column, text.path, kept)
        for column, place in zip(columns, places, strict=True)
        if isinstance(column, WordColumn)
    }
    return Table(text.path, np.array(kept), found, words, tuple(notes))


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


def _loose_end(rows: list[list[str]], columns: Sequence[AnyColumn], places: Sequence[int], text: TextFile) -> str:
    """Take the last cell of a file without a last line end for missing, since nobody knows how it goes on."""
    last = len(rows[-1]) - 1
    for column, place in zip(columns, places, strict=True):
        if place == last and isinstance(column, Column) and column.may_be_empty:
            rows[-1][last] = ""
            return (
                f"{text.path.name} has no line end after its last row: the cell in column {column.name} may be cut "
                "off and is taken for missing; add a line end if it is whole"
            )
    raise InputError(
        "has no line end: the file may be cut off",
        where=f"{text.path}: row {len(text.lines)}",
        cure="add a line end if the row is whole, or remove the row",
    )


def _numbers(cells: list[str], column: Column, path: Path, row: Sequence[int]) -> Array:
    allowed = "a number or an empty cell" if column.may_be_empty else "a number"
    values = np.full(len(cells), nan)
    for i, cell in enumerate(cells):
        if column.may_be_empty and not cell.strip():
            continue
        values[i] = number(cell, path, row[i], column.name, allowed)
    _check_scale(values, column, path, row)
    if column.decimals == 0:
        fractions = np.flatnonzero(values % 1.0 > 0.0)
        if len(fractions):
            i = int(fractions[0])
            where = f"{path}: row {row[i]}"
            raise InputError(f"column {column.name}", where=where, got=float(values[i]), allowed="a whole number")
    return values


def _check_scale(values: Array, column: Column, path: Path, row: Sequence[int]) -> None:
    typical = beyond_scale(values, column.reach)
    allowed = column.reach.words(column.unit)
    if typical is not None:
        cure = likely_unit(typical, column.reach, column.unit) or "check the column's unit"
        what = f"column {column.name}: most values are out of scale, in the middle {typical:.4g}"
        raise InputError(what, where=str(path), allowed=allowed, cure=cure)
    beyond = np.flatnonzero(~column.reach.holds(values))
    if len(beyond) and column.role is Role.INPUT:
        i = int(beyond[0])
        cure = "mend or remove the row: what was set must be known"
        where = f"{path}: row {row[i]}"
        raise InputError(f"column {column.name}", where=where, got=float(values[i]), allowed=allowed, cure=cure)


def _words(cells: list[str], column: WordColumn, path: Path, row: Sequence[int]) -> tuple[str, ...]:
    for i, cell in enumerate(cells):
        where = f"{path}: row {row[i]}"
        if not cell:
            raise InputError(f"column {column.name}", where=where, got="", allowed="a word")
        if column.allowed and cell not in column.allowed:
            allowed = f"one of {', '.join(column.allowed)}"
            close = nearest(cell, column.allowed)
            raise InputError(f"column {column.name}", where=where, got=cell, allowed=allowed, nearest=close)
    return tuple(cells)

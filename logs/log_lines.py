"""The lines of a log and their cells, whatever separates them, and the numbers in quoted cells."""

import csv
import re
from collections.abc import Sequence

from logs.recognition import MAX_TITLES
from symolo.core.errors import InputError
from symolo.core.tables.table import cells_of, number_of

SEPARATORS = (",", ";", "\t")
_NUMBER = re.compile(r"[-+]?\d[\d,]*(\.\d*)?")
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(,\d{3})+(\.\d*)?")
"""A number such as 1,440 or 12,345.6."""


def with_tabs(lines: Sequence[str]) -> list[str]:
    """Return the lines of a table whose cells are separated by spaces with tabs in place of these.

    Lines of other files stay as they are. A comment above the rows with as many words as they have is their header. A
    title above it, with another number of words, may have any separators.
    """
    rows = [line for line in lines if line.strip() and not line.startswith("#")]
    width = len(rows[-2 if len(rows) > 2 else -1].split()) if rows else 0  # the last row may be cut off
    titles = next((k for k, line in enumerate(rows[: MAX_TITLES + 1]) if len(line.split()) == width), 0)
    rows = rows[titles:]
    is_spaced = width > 1 and not any(separator in line.strip() for line in rows for separator in SEPARATORS)
    if not is_spaced or not any(number_of(word) == number_of(word) for word in rows[-1].split()):
        return [*lines]
    return [_with_tabs(line, width) for line in lines]


def _with_tabs(line: str, width: int) -> str:
    """Return a row with tabs for its spaces, and a comment that may be the header of rows with so many cells, too."""
    words = line.lstrip("# ").split()
    if line.startswith("#"):
        return "#" + "\t".join(words) if len(words) == width else line
    return "\t".join(words)


def cells_in(line: str, separator: str) -> list[str]:
    """Return the cells of a line without the spaces and quotes around them; a separator in quotes separates nothing."""
    if '"' not in line:
        return cells_of(line, separator)
    try:
        cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    except csv.Error:  # of a cell of more than 131,072 characters
        cells = cells_of(line, separator)
    return [cell.strip().strip('"') for cell in cells]


def with_plain_numbers(rows: Sequence[Sequence[str]], where: str) -> tuple[list[list[str]], bool]:
    """Return the rows of a file with commas as separators, and whether the commas in its quoted cells are decimal ones.

    Commas between thousands, as in "1,440", are left out.

    Raises:
        InputError: The commas may be either.
    """
    cells = [cell for row in rows for cell in row if "," in cell and _NUMBER.fullmatch(cell)]
    if not cells:
        return [[*row] for row in rows], False
    has_points = any("." in cell and _NUMBER.fullmatch(cell) for row in rows for cell in row)
    if not has_points and not all(map(_THOUSANDS.fullmatch, cells)):
        return [[*row] for row in rows], True
    if not has_points:
        what = "numbers with a comma, which may be a decimal one or stand between thousands"
        raise InputError(what, where=where, got=cells[0], cure="save the file with points for decimals")
    return [[cell.replace(",", "") if _THOUSANDS.fullmatch(cell) else cell for cell in row] for row in rows], False

"""Comparison of two tables of numbers: the largest difference of each column, in its own digits."""

import math
from dataclasses import dataclass
from pathlib import PurePosixPath

import numpy as np

from symolo.compare.likeness import Likeness, level_db
from symolo.core.arrays import Array
from symolo.core.progress import plural

NAMES = frozenset({"t", "state", "img", "status_f", "status_l", "status_r"})
"""Columns whose numbers are names, so that no difference is small."""
SEPARATORS = {".csv": ",", ".txt": " "}


@dataclass(frozen=True)
class WorstColumn:
    """The column of two tables that differs most."""

    name: str
    a: Array
    b: Array
    """(N,), its numbers in both."""


def worst_column(a: bytes, b: bytes, name: str) -> WorstColumn | None:
    """Return the column that differs most between two tables of the same columns and rows; None for any others."""
    separator = SEPARATORS[PurePosixPath(name).suffix]
    try:
        (header, table_a), (other, table_b) = _read(a, separator), _read(b, separator)
    except ValueError:
        return None
    if header != other or table_a.shape != table_b.shape:
        return None
    levels = [
        (_column(title, table_a[:, i], table_b[:, i]).level_db, i)
        for i, title in enumerate(header)
        if not np.array_equal(table_a[:, i], table_b[:, i], equal_nan=True)
    ]
    if not levels:
        return None
    _, worst = min(levels)
    return WorstColumn(header[worst], table_a[:, worst], table_b[:, worst])


def likeness(a: bytes, b: bytes, name: str) -> Likeness:
    separator = SEPARATORS[PurePosixPath(name).suffix]
    try:
        (header, table_a), (other, table_b) = _read(a, separator), _read(b, separator)
    except ValueError:
        return Likeness.none(_first_line(a, b))
    if header != other:
        return Likeness.none(f"columns {separator.join(header)[:60]} in A, {separator.join(other)[:60]} in B")
    if table_a.shape != table_b.shape:
        return Likeness.none(f"{plural(len(table_a), 'row')} in A, {len(table_b)} in B")
    columns = [
        _column(title, table_a[:, i], table_b[:, i])
        for i, title in enumerate(header)
        if not np.array_equal(table_a[:, i], table_b[:, i], equal_nan=True)
    ]
    if not columns:
        return Likeness(math.inf, "the same numbers in other bytes")
    worst = min(columns, key=lambda column: column.level_db)
    more = f", and {len(columns) - 1} more columns by less" if len(columns) > 1 else ""
    return Likeness(worst.level_db, worst.what + more)


def _column(title: str, a: np.ndarray, b: np.ndarray) -> Likeness:
    wrong = np.flatnonzero((a != b) & ~(np.isnan(a) & np.isnan(b)))
    finite = np.isfinite(a) & np.isfinite(b)
    if title in NAMES or not finite[wrong].all():
        at = wrong[0] if title in NAMES else wrong[~finite[wrong]][0]
        return Likeness.none(
            f"column {title}: {a[at]:g} in A, {b[at]:g} in B at line {at + 2}; different in {plural(len(wrong), 'row')}"
        )
    differences = np.where(finite, a, 0.0) - np.where(finite, b, 0.0)
    at = int(np.argmax(np.abs(differences)))
    what = f"column {title}: by up to {abs(differences[at]):.6g} at line {at + 2}"
    return Likeness(level_db(differences, float(np.max(np.abs(a[finite])))), what)


def _read(data: bytes, separator: str) -> tuple[list[str], np.ndarray]:
    """Return header and numbers; raise ValueError for any other content."""
    first, *lines = data.decode().splitlines()
    header = first.split(separator)
    rows = [line.split(separator) for line in lines]
    if any(len(row) != len(header) for row in rows):
        raise ValueError("rows of another length than the header")
    return header, np.array(rows, dtype=np.float64).reshape(len(rows), len(header))


def _first_line(a: bytes, b: bytes) -> str:
    """Return where two texts that are no tables begin to differ."""
    lines_a, lines_b = a.splitlines(), b.splitlines()
    for number, (line_a, line_b) in enumerate(zip(lines_a, lines_b, strict=False), start=1):
        if line_a != line_b:
            return f"line {number} differs"
    if len(lines_a) == len(lines_b):
        return "line ends differ"
    return f"{plural(len(lines_a), 'line')} in A, {len(lines_b)} in B"

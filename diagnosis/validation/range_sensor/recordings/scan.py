"""Scan of a real sensor over a grid, with several readings at each point in the order of time."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np

from symolo.core.arrays import Array
from symolo.core.errors import InputError, nearest
from symolo.core.files.text_file import read_text
from symolo.core.tables.table import NumberColumn, cells_of, table_of

MAX_RANGE_MM = 8189.0
"""Largest range [mm]; the device's codes for "no target" begin above."""
COLUMNS = (NumberColumn("x"), NumberColumn("y"), NumberColumn("lidar", low=0.0, high=MAX_RANGE_MM))
MIN_POINTS = 20
MIN_READINGS = 3


@dataclass(frozen=True)
class ScanRecording:
    """P points with K readings each, in the order of the scan."""

    x_mm: Array
    """(P,), x of each point."""
    y_mm: Array
    """(P,), y of each point."""
    reading_mm: Array
    """(P, K), readings; the first of each point is right after the move."""

    @property
    def settled_mm(self) -> Array:
        """Return the median of the last half of the readings of each point, (P,)."""
        return np.median(self.reading_mm[:, self.reading_mm.shape[1] // 2 :], axis=1)


def read_scan(path: Path) -> ScanRecording:
    """Read the columns x, y [mm] and lidar [mm] of a file with a header, and ignore further columns.

    Raises:
        InputError: A column or a number is missing or wrong, or points differ in how many readings they have; the
            message names file, row and column.
    """
    text = read_text(path)
    header = cells_of(text.lines[0])
    for column in COLUMNS:
        if column.name not in header:
            close = nearest(column.name, header)
            raise InputError(f"column {column.name} is missing", where=f"{path}: row 1", got=header, nearest=close)
    places = [header.index(column.name) for column in COLUMNS]
    table = table_of(text, COLUMNS, places, first=1).checked()
    rows = zip(*(table.numbers[column.name].tolist() for column in COLUMNS), strict=True)
    return _grouped(list(rows), path)


def _grouped(rows: Sequence[tuple[float, float, float]], path: Path) -> ScanRecording:
    points = [(place, [row[2] for row in some]) for place, some in groupby(rows, key=lambda row: row[:2])]
    if len(points) < MIN_POINTS:
        raise InputError(f"has {len(points)} points", where=str(path), allowed=f"at least {MIN_POINTS}")
    count, row = len(points[0][1]), 2
    for (x_mm, y_mm), readings in points:
        if len(readings) != count or count < MIN_READINGS:
            what = f"column lidar: {len(readings)} readings at x = {x_mm:g}, y = {y_mm:g}"
            allowed = f"at least {MIN_READINGS}, as many at each point"
            raise InputError(what, where=f"{path}: row {row}", allowed=allowed)
        row += len(readings)
    places = np.array([place for place, _ in points])
    return ScanRecording(places[:, 0], places[:, 1], np.array([readings for _, readings in points]))

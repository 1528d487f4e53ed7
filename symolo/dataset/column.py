"""A column of data.csv or of a table in `side/`."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Column:
    """Name, unit, digits and meaning of a column."""

    name: str
    unit: str
    """For example `m` or `rad`; `-` for a number without a unit."""
    decimals: int
    """Digits after the point in the file; a column of 0 digits holds whole numbers."""
    meaning: str = ""

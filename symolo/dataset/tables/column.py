"""Columns of data.csv and of the tables in `side/`, and the series of a recording from which they are written."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Column:
    """Name, unit, digits and meaning of a column."""

    name: str
    unit: str
    """For example `m` or `rad`; `-` for a number without a unit."""
    decimals: int
    """Digits after the point in the file; a column of 0 digits has whole numbers."""
    meaning: str = ""


@dataclass(frozen=True)
class Series:
    """One series of a recording, with its columns in a dataset."""

    name: str
    unit: str
    columns: tuple[Column, ...] = ()
    """One column for each value of a row; empty for a series that is not in a dataset."""

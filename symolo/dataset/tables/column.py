"""Columns of data.csv and of the tables in `side/`, and the series of a recording from which they are written."""

from collections.abc import Iterable
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Column:
    """Name, unit, digits and meaning of a column, or of several columns of the same kind."""

    name: str
    unit: str
    """Unit, for example `m` or `rad`; `-` for a number without a unit."""
    decimals: int
    """Digits after the point in the file; a column of 0 digits has whole numbers."""
    meaning: str = ""
    count: int = 1
    """Number of columns. More than one are numbered from 0: `range` stands for `range_0`, `range_1`..."""

    def __post_init__(self) -> None:
        """Refuse a column whose parts were given in another order, before anything is simulated with it.

        Raises:
            TypeError: A part has another type.
        """
        parts = {"name": str, "unit": str, "decimals": int, "meaning": str, "count": int}
        for part, kind in parts.items():
            if not isinstance(value := getattr(self, part), kind):
                expected = "a text" if kind is str else "a whole number"
                raise TypeError(f"the {part} of column {self.name} is {value!r}, but must be {expected}")

    @property
    def title(self) -> str:
        """Name as a person reads it, such as `range_0..range_359`."""
        return self.name if self.count == 1 else f"{self.name}_0..{self.name}_{self.count - 1}"


def single(columns: Iterable[Column]) -> tuple[Column, ...]:
    """Return columns with one entry for each column of the file."""
    return tuple(
        column if column.count == 1 else replace(column, name=f"{column.name}_{number}", count=1)
        for column in columns
        for number in range(column.count)
    )


@dataclass(frozen=True)
class Series:
    """One series of a recording, with its columns in a dataset."""

    name: str
    unit: str
    columns: tuple[Column, ...] = ()
    """One column for each value of a row; empty for a series that is not in a dataset."""

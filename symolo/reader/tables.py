"""Numbers of a file as a table that knows its units."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from symolo.core.arrays import Array
from symolo.dataset.tables.column import Column
from symolo.dataset.tables.rows import Rows

UNITS = "units"
"""Key of a table's `attrs` that holds the unit of each column."""


def frame(columns: Sequence[Column], numbers: Array) -> pd.DataFrame:
    """Return a table of numbers (N, columns); columns without decimals and without empty cells are integers.

    `attrs["units"]` is the unit of each column: m, rad, ms...; "-" for a column without one.
    """
    made = {
        column.name: values.copy() if column.decimals or np.isnan(values).any() else values.round().astype("int64")
        for column, values in zip(columns, numbers.T, strict=True)
    }
    table = pd.DataFrame(made)
    table.attrs[UNITS] = {column.name: column.unit for column in columns}
    return table


def rows_frame(rows: Rows) -> pd.DataFrame:
    """Return the columns of data.csv as a table."""
    return frame(rows.definitions, rows.table())

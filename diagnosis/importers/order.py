"""Rows in the order of time, or refused."""

import numpy as np

from configs.errors import InputError
from diagnosis.measured.channel import Mask
from diagnosis.measured.csv_table import Table


def check_increasing(table: Table, column: str, within: Mask | None = None) -> None:
    """Refuse a column that does not increase from each row to the next.

    Args:
        table: As read.
        column: Its name there.
        within: (N - 1,), whether a row and the next are of the same trial; all by default.

    Raises:
        InputError: With the first row that is not after the one above.
    """
    values = table.numbers[column]
    falls = np.diff(values) <= 0.0
    wrong = np.flatnonzero(falls if within is None else within & falls)
    if len(wrong):
        i = int(wrong[0]) + 1
        how = "repeats" if values[i] == values[i - 1] else "goes back from"
        what = f"column {column}: {values[i]:.10g} {how} {values[i - 1]:.10g} of the row above"
        raise InputError(what, where=table.where(i), cure="put the rows in order, and keep one of each time")

"""Voltages that are held over another row than is usual for the kind of case, as a mapping may state."""

from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np

from diagnosis.measured.measurement import CaseKind
from logs.mapping import LogMapping
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.progress import plural

OTHER_THAN_USUAL: Mapping[CaseKind, str] = {CaseKind.MOTOR_STEP: "after_row", CaseKind.DRIVE_LOG: "before_row"}
"""Value of `held` that differs from the rule of the kind: in a step log, the voltage of a row was held since the row
before; in a drive, it is held until the next row."""


def held_otherwise(mapping: LogMapping, kind: CaseKind) -> list[str]:
    """Return the voltages of a log that are held over another row than is usual for the kind."""
    other = OTHER_THAN_USUAL.get(kind)
    return [name for name, source in mapping.columns.items() if other and source.held == other]


def left_out_notes(rows: Sequence[int], where: str) -> Iterator[str]:
    """Yield a note if trials have a single row, of which the voltage is not known.

    Args:
        rows: Number of rows of each trial.
        where: Path of the log.

    Raises:
        InputError: No trial has two rows whose voltage is known.
    """
    if max(rows) < 3:
        raise InputError("no trial has three rows, of which held leaves two", where=where)
    if single := sum(count < 2 for count in rows):
        yield f"left out, because the voltage of their only row is not known: {plural(single, 'trial')}"


def held_by_other_rows(
    t_s: Array, values: Mapping[str, Array], names: Collection[str], kind: CaseKind
) -> tuple[Array, dict[str, Array]]:
    """Return times and columns of a trial with the voltages in the rows in which the kind has them.

    One row is left out, of which the voltage is not known: the first of a step log, and the last of a drive.

    Args:
        t_s: (N,), times of the rows.
        values: (N,) of each column.
        names: Voltages that are held over another row.
        kind: Kind of the case.
    """
    here, there = slice(1, None), slice(None, -1)
    if kind is CaseKind.DRIVE_LOG:
        here, there = there, here
    moved = {name: column[there if name in names else here] for name, column in values.items()}
    return np.array(t_s[here]), moved

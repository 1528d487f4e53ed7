"""Voltages that are held over another row than is usual for the kind of case, as a mapping may state."""

from collections.abc import Collection, Mapping

import numpy as np

from diagnosis.measured.measurement import CaseKind
from logs.mapping import LogMapping
from symolo.core.arrays import Array

OTHER_THAN_USUAL: Mapping[CaseKind, str] = {CaseKind.MOTOR_STEP: "after_row", CaseKind.DRIVE_LOG: "before_row"}
"""Value of `held` that differs from the rule of the kind: in a step log, the voltage of a row was held since the row
before; in a drive, it is held until the next row."""


def held_otherwise(mapping: LogMapping, kind: CaseKind) -> list[str]:
    """Return the voltages of a log that are held over another row than is usual for the kind."""
    other = OTHER_THAN_USUAL.get(kind)
    return [name for name, source in mapping.columns.items() if other and source.held == other]


def of_other_rows(
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

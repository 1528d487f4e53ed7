"""The table `side/<name>.csv` of each sensor in `robot.sensors`; metadata.json describes its columns."""

from collections.abc import Iterator, Sequence

import numpy as np

from symolo.core.arrays import Array
from symolo.core.time_series import Recording
from symolo.dataset.tables.column import Column
from symolo.dataset.tables.side_tables import SideTable

SERIES = "sensor_{name}"
"""Series of a recording with the readings of a sensor, (rows, columns)."""
TIME = Column("t", "ms", 0)
"""First column of each table."""
TAKEN_NAMES = frozenset({"wheels", "tof", "camera", "board", "obstacles", "intrinsics", "scene", "spec"})
"""Names of files in `side/` that are not allowed for sensors."""
SENSOR_NAME = r"^[a-z][a-z0-9_]{0,62}$"
"""Pattern of the name of a sensor, which is also the name of its file."""


def sensor_table(name: str, meaning: str, columns: Sequence[Column]) -> SideTable:
    """Return the table of a sensor with these columns after the time."""
    return SideTable(f"{name}.csv", meaning, (TIME, *columns))


def sensor_csv(table: SideTable, recording: Recording) -> bytes:
    """Return the file of a sensor's table: one row for each row of data.csv."""
    readings = recording[SERIES.format(name=table.name)].values
    return table.to_csv(np.column_stack((np.rint(recording.trajectory.t_s * 1000), readings)))


def fractions(table: SideTable, numbers: Array) -> Iterator[str]:
    """Yield a text for each number (rows, columns) that is not whole in a column of whole numbers."""
    for i, column in enumerate(table.columns):
        if column.decimals == 0:
            for row in np.flatnonzero(numbers[:, i] % 1):
                yield f"line {row + 2}: column {column.name}: {numbers[row, i]:g} is not a whole number"

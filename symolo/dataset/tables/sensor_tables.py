"""The table `side/<name>.csv` of each sensor in `robot.sensors`; metadata.json describes its columns."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array
from symolo.core.tables.time_series import Recording
from symolo.dataset.tables.column import Column
from symolo.dataset.tables.side_tables import SideTable

SERIES = "sensor_{name}"
"""Series of a recording with the readings of a sensor, (samples, columns)."""
TIME = Column("t", "ms", 3, "time of the sample since the start of the run")
"""First column of each table."""
TAKEN_NAMES = frozenset(
    (
        "board",
        "camera",
        "encoders",
        "intrinsics",
        "line",
        "obstacles",
        "pose_log",
        "scene",
        "spec",
        "tof",
        "wheels",
    )
)
"""Names that are not allowed for sensors: those of files in `side/` and of the sensors that every robot has."""
SENSOR_NAME = r"^[a-z][a-z0-9_]{0,62}$"
"""Pattern of the name of a sensor, which is also the name of its file."""
LOGGED = "logged"
"""Kind of the sensors of an imported run: a table of what a log has beside the poses."""
MAX_COLUMNS = 10_000
"""Largest number of columns of one kind."""


@dataclass(frozen=True)
class ListedSensor:
    """A sensor of `robot.sensors` as a dataset describes it."""

    kind: str
    table: SideTable


def sensor_table(name: str, meaning: str, columns: Sequence[Column], *, may_be_empty: bool = False) -> SideTable:
    """Return the table of a sensor with these columns after the time, one row for each sample."""
    return SideTable(f"{name}.csv", meaning, (TIME, *columns), "samples", may_be_empty)


def sensor_csv(table: SideTable, recording: Recording) -> bytes:
    """Return the file of a sensor's table."""
    series = recording[SERIES.format(name=table.name)]
    return table.to_csv(np.column_stack((series.t_s * 1000, series.values)))


def sample_times_ms(period_s: float, physics_hz: int, end_ms: float) -> Array:
    """Return the times of the samples of a sensor until `end_ms`, with the digits of a table."""
    period_ms = max(1, round(period_s * physics_hz)) * 1000 / physics_hz
    return np.round(np.arange(int((end_ms + 1e-6) // period_ms) + 1) * period_ms, TIME.decimals)


def fractions(table: SideTable, numbers: Array) -> Iterator[str]:
    """Yield a text for each number (rows, columns) that is not whole in a column of whole numbers."""
    for i, column in enumerate(table.cells):
        if column.decimals == 0:
            for row in np.flatnonzero(np.nan_to_num(numbers[:, i]) % 1):
                yield f"line {row + 2}: column {column.name}: {numbers[row, i]:g} is not a whole number"

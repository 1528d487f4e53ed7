"""Poses of the moving obstacles of a run: the series of the recording, and side/obstacles.csv."""

from collections.abc import Iterator, Sequence

import numpy as np

from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.core.tables.time_series import Recording, TimeSeries
from symolo.dataset.tables.column import Column
from symolo.dataset.tables.rows import ROW_TIME, Rows, heading, wrapped
from symolo.dataset.tables.side_tables import SideTable

SERIES = "obstacle_{name}"
TOLERANCE = 1e-6
"""Largest allowed difference between table and path: twice the rounding of the digits [m, rad]."""


def obstacle_series(arena: Arena, t_s: Array) -> tuple[TimeSeries, ...]:
    """Return the poses of each moving obstacle in W, (N, 3), x [m], y [m], yaw [rad] of its middle, at times (N,)."""
    return tuple(TimeSeries(SERIES.format(name=box.name), "m, m, rad", t_s, box.poses_at(t_s)) for box in arena.moving)


def obstacle_table(arena: Arena) -> SideTable | None:
    """Return the table of the obstacles of an arena; None if none moves."""
    if not arena.moving:
        return None
    columns = [
        Column(f"{box.name}_{field}", unit, 6, f"{meaning} of {box.name}")
        for box in arena.moving
        for field, unit, meaning in (
            ("x", "m", "x in W of the middle"),
            ("y", "m", "y in W of the middle"),
            ("theta", "rad", "heading in W, counter-clockwise,"),
        )
    ]
    meaning = "pose of the middle of each moving obstacle in W at each row of data.csv"
    return SideTable("obstacles.csv", meaning, (ROW_TIME, *columns))


def obstacles_csv(table: SideTable, arena: Arena, recording: Recording) -> bytes:
    """Return the table of a simulation."""
    poses = [recording[SERIES.format(name=box.name)].values.astype(np.float64) for box in arena.moving]
    return _csv(table, np.rint(recording.trajectory.t_s * 1000), poses)


def obstacles_csv_at(table: SideTable, arena: Arena, rows: Rows, row_hz: int | None) -> bytes:
    """Return the table for the rows of a data.csv; rates as for `row_times_s`."""
    t_s = row_times_s(rows, row_hz)
    return _csv(table, rows.t_ms.astype(np.float64), [box.poses_at(t_s) for box in arena.moving])


def _csv(table: SideTable, t_ms: Array, poses: Sequence[Array]) -> bytes:
    rounded = [np.column_stack((pose[:, :2], heading(pose[:, 2], 6))) for pose in poses]
    return table.to_csv(np.column_stack((t_ms, *rounded)))


def row_times_s(rows: Rows, row_hz: int | None) -> Array:
    """Return the times of rows (N,) [s]: the exact periods of a simulation, or without a rate the times of data.csv."""
    return np.arange(len(rows.t_ms)) / row_hz if row_hz else rows.t_ms / 1000


def off_the_path(arena: Arena, table: Array, rows: Rows, row_hz: int | None) -> Iterator[tuple[str, list[int]]]:
    """Yield the name of each obstacle whose poses in the table differ from its path, and the rows that differ."""
    t_s = row_times_s(rows, row_hz)
    for number, box in enumerate(arena.moving):
        pose = table[:, 1 + 3 * number : 4 + 3 * number]
        difference = pose - box.poses_at(t_s)
        difference[:, 2] = wrapped(difference[:, 2])
        wrong = np.flatnonzero(np.any(np.abs(difference) > TOLERANCE, axis=1))
        if len(wrong):
            yield box.name, wrong.tolist()

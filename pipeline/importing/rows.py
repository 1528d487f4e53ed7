"""A logged trajectory as data.csv and tables beside it."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from logs.decimals import decimals_of
from logs.times import usual_step
from logs.trajectories.base import LoggedSensor, LoggedTable, LoggedTrajectory
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.progress import plural
from symolo.dataset.tables.column import Column
from symolo.dataset.tables.rows import COLUMNS, HEADER, MAY_BE_EMPTY, RANGES, REQUIRED, Rows, heading, rounded
from symolo.dataset.tables.sensor_tables import LOGGED, TIME, sensor_table
from symolo.dataset.tables.side_tables import SideTable

MAX_ROWS = 2_000_000
"""Number of rows that a trajectory may have; more exceed the memory that later commands need."""
READING_STEPS = 1.5
"""Largest distance of a reading from the time of a row, in usual steps, after a new sampling."""
_PLAIN_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,59}")


@dataclass(frozen=True)
class ImportedTable:
    """A table beside data.csv."""

    kind: str
    """Kind of the sensor whose samples it has, or `logged`."""
    table: SideTable
    numbers: Array
    """(samples, columns), the time [ms] first."""
    settings: Mapping[str, float]
    """Known settings of the sensor."""


@dataclass(frozen=True)
class ImportedRows:
    """The tables of a run."""

    rows: Rows
    tables: tuple[ImportedTable, ...]
    """Tables in the order of their names, as metadata.json has them."""
    changes: tuple[str, ...]
    """Changes of the data, in one sentence each."""


def imported_rows(
    trajectory: LoggedTrajectory,
    where: str,
    no_target_m: float,
    row_hz: float | None = None,
    *,
    with_images: bool = False,
) -> ImportedRows:
    """Return the tables of a trajectory, whose times begin with 0.

    Args:
        trajectory: The trajectory.
        where: Place of the log for messages.
        no_target_m: Range in data.csv where a sensor saw no target.
        row_hz: Rate at which the trajectory is sampled again; by default its own times stay, rounded to milliseconds.
        with_images: Whether the column `img` of a data.csv says at which rows images are to be taken.

    Raises:
        InputError: It has fewer than two rows, or too many.
    """
    if len(trajectory.t_s) < 2:
        raise InputError("has fewer than two poses", where=where)
    start_s = trajectory.t_s[0]
    since_s = trajectory.t_s - start_s
    changes = []
    if row_hz is not None:
        step_s = usual_step(np.diff(since_s))
        times_s = np.arange(int(np.floor(since_s[-1] * row_hz + 1e-6)) + 1) / row_hz
        changes.append(f"rows, {step_s:.4g} s apart, are sampled again at {row_hz:g} Hz")
        trajectory, since_s = _sampled(trajectory, since_s, times_s), times_s
    t_ms = np.rint(1000.0 * since_s)
    chosen = np.flatnonzero(np.concatenate(([True], np.diff(t_ms) > 0.0)))
    if len(chosen) < len(t_ms):
        changes.append(f"left out: {plural(len(t_ms) - len(chosen), 'row')} within a millisecond of the row above")
    if not 2 <= len(chosen) <= MAX_ROWS:
        cure = "" if len(chosen) < 2 else "sample it again with --row-hz"
        raise InputError("rows", where=where, got=len(chosen), allowed=f"2 to {MAX_ROWS}", cure=cure)
    readings = {name: values[chosen] for name, values in trajectory.readings.items() if with_images or name != "img"}
    rows = _rows(t_ms[chosen], trajectory.pose[chosen], readings, no_target_m)
    if without := [name for name in HEADER if name in readings and name not in rows.columns]:
        text = "columns of data.csv that are left out, because no row has a reading"
        changes.append(f"{text}: {', '.join(without)}")
    tables = [_table(table, rows, chosen) for table in trajectory.tables]
    for sensor in trajectory.sensors:
        table = _sensor_table(sensor, start_s, int(rows.t_ms[-1]))
        changes += _samples_left_out(sensor, len(table.numbers))
        tables += [table] if len(table.numbers) else []
    return ImportedRows(rows, tuple(sorted(tables, key=lambda one: one.table.name)), tuple(changes))


def _rows(t_ms: Array, pose: Array, readings: dict[str, Array], no_target_m: float) -> Rows:
    # Infinity is the reading of a range sensor that saw no target, and none of anything else.
    ranges = {column.name for column in RANGES.columns}
    is_read = {name: ~np.isnan(each) if name in ranges else np.isfinite(each) for name, each in readings.items()}
    measured = [name for name in HEADER if name in readings and is_read[name].any()]
    columns = tuple(name for name in HEADER if name in (*REQUIRED, *measured))
    values: dict[str, Array] = dict(zip(REQUIRED, (t_ms, *pose.T), strict=True))
    for name in measured:
        limit = no_target_m if name in ranges else np.nan
        values[name] = np.where(np.isinf(readings[name]), limit, readings[name])
    definitions = [column for column in COLUMNS if column.name in columns]
    decimals = {column.name: column.decimals for column in definitions}
    values["theta"] = heading(values["theta"], decimals["theta"])
    table = rounded(np.column_stack([values[name] for name in columns]), definitions)
    return Rows.from_table(table, columns)


def _sampled(trajectory: LoggedTrajectory, since_s: Array, times_s: Array) -> LoggedTrajectory:
    """Return the trajectory at other times: poses between their neighbours, readings of the nearest row."""
    x, y, yaw = trajectory.pose.T
    pose = np.column_stack([np.interp(times_s, since_s, coordinate) for coordinate in (x, y, np.unwrap(yaw))])
    after = np.clip(np.searchsorted(since_s, times_s), 1, len(since_s) - 1)
    nearest = np.where(times_s - since_s[after - 1] <= since_s[after] - times_s, after - 1, after)
    is_near = np.abs(since_s[nearest] - times_s) <= READING_STEPS * usual_step(np.diff(since_s))

    def taken(values: Array) -> Array:
        return np.where(is_near, values[nearest], np.nan)

    names = [name for name in trajectory.readings if name in MAY_BE_EMPTY]
    return replace(
        trajectory,
        t_s=times_s.copy(),
        pose=pose,
        readings={name: taken(trajectory.readings[name]) for name in names},
        tables=tuple(
            replace(table, columns={name: (unit, taken(values)) for name, (unit, values) in table.columns.items()})
            for table in trajectory.tables
        ),
    )


def _sensor_table(sensor: LoggedSensor, start_s: float, end_ms: int) -> ImportedTable:
    """Return the samples between the first and the last row, with times since the first one, `start_s` in the log."""
    t_ms = np.round(1000.0 * (sensor.t_s - start_s), TIME.decimals)
    is_taken = (t_ms >= 0.0) & (t_ms <= end_ms) & np.concatenate(([True], np.diff(t_ms) > 0.0))
    numbers = np.column_stack((t_ms, sensor.values))[is_taken]
    table = sensor_table(sensor.name, sensor.meaning, sensor.columns, may_be_empty=True)
    return ImportedTable(sensor.kind, table, numbers, sensor.settings)


def _samples_left_out(sensor: LoggedSensor, kept_samples: int) -> list[str]:
    left_out = len(sensor.t_s) - kept_samples
    text = f"{sensor.name}: left out: {plural(left_out, 'sample')} before the first or after the last row"
    return [f"{text}, or with the time of another one"] if left_out else []


def _table(table: LoggedTable, rows: Rows, chosen: np.ndarray) -> ImportedTable:
    numbers = [values[chosen] for _, values in table.columns.values()]
    columns = [
        Column(name, unit, decimals_of(values), original)
        for name, (original, (unit, _)), values in zip(
            unique_names(list(table.columns)), table.columns.items(), numbers, strict=True
        )
    ]
    period_s = usual_step(np.diff(rows.t_ms)) / 1000
    return ImportedTable(
        LOGGED,
        sensor_table(table.name, table.meaning, columns, may_be_empty=True),
        np.column_stack((rows.t_ms.astype(np.float64), *numbers)),
        {"period_s": period_s, "delay_s": 0.0},
    )


def unique_names(names: Sequence[str]) -> list[str]:
    """Return names of letters, digits and `_`, each once, for columns of any names."""
    result: list[str] = []
    for name in names:
        plain = name if _PLAIN_NAME.fullmatch(name) else re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")[:60]
        plain = plain or "column"
        taken, number = plain, 2
        while taken in {*result, "t"}:
            taken, number = f"{plain}_{number}", number + 1
        result.append(taken)
    return result

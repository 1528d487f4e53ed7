"""Log of a VL53L0X that was moved over a grid: columns x, y and lidar [mm], several readings at each point."""

from pathlib import Path

import numpy as np

from diagnosis.importers.base import Importer
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.validation.range_sensor.recordings.scan import COLUMNS, read_scan
from logs.recognition import first_line, only_log
from symolo.core.arrays import Array
from symolo.core.tables.time_series import TimeSeries

HELD_OUT = 4
"""One point of this many is held out."""


def _is_log(path: Path) -> bool:
    return {column.name for column in COLUMNS} <= set(first_line(path).split(","))


def _read(path: Path) -> Measurement:
    path = only_log(path, _is_log) or path
    scan = read_scan(path)
    points, count = scan.reading_mm.shape
    row = np.arange(points * count, dtype=np.float64)

    def channel(name: str, values_mm: Array, role: Role) -> Channel:
        return Channel.logged(TimeSeries(name, "m", row, 1e-3 * values_mm), role)

    channels = (
        channel("x_m", np.repeat(scan.x_mm, count), Role.INPUT),
        channel("y_m", np.repeat(scan.y_mm, count), Role.INPUT),
        channel("reading_m", scan.reading_mm.ravel(), Role.READING),
    )
    holdout = np.repeat(np.arange(points) % HELD_OUT == HELD_OUT - 1, count)
    trial = Trial("1", row, holdout, channels, is_timed=False)
    source = MeasurementSource("VL53L0X over a grid, OSUrobotics/applevision_tof_profiler", (str(path),), "MIT")
    notes = (
        f"{points} points with {count} readings each; the first ones after a move may be of the previous place",
        "not logged: times, distance",
        f"every {HELD_OUT}th point is held out",
    )
    return Measurement(path.stem, CaseKind.RANGE_SCAN, source, (trial,), notes=notes)


IMPORTER = Importer("vl53l0x-scan", lambda path: only_log(path, _is_log) is not None, _read)

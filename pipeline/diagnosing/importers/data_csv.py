"""A single SyMoLo data.csv: pose, speeds, ranges and line readings."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from diagnosis.importers.base import Importer
from diagnosis.measured.channel import Channel, Mask, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from logs.recognition import first_line
from symolo.core.arrays import Array
from symolo.core.tables.time_series import TimeSeries
from symolo.dataset.layout import DATA
from symolo.dataset.tables.rows import COLUMNS, HEADER, REQUIRED, Ints, Rows, read_rows

RANGES = {"tof_front_m": 0, "tof_left_m": 1, "tof_right_m": 2}
MIN_COUNT = 3
"""Smallest number of readings of exactly the largest range for which it may be the code for "no target"."""
MIN_CODE_M = 1.0
"""Smallest code [m] for "no target" of any sensor."""
MIN_GAP_M = 0.05
"""Smallest distance [m] of the code from the next lower reading; ranges to a wall have no such gap."""


def row_channels(rows: Rows, no_target: Mask, stale: Mask) -> tuple[Channel, ...]:
    """Return the columns of data.csv as channels; what was not measured is none.

    Args:
        rows: Rows of data.csv.
        no_target: (N, 3), whether front, left and right sensor had no target.
        stale: (N, 3), whether they repeated the reading before.
    """
    t_s = 1e-3 * rows.t_ms
    units = {column.name: column.unit for column in COLUMNS}

    def series(name: str, unit: str, values: Array | Ints) -> TimeSeries:
        return TimeSeries(name, unit, t_s, values.astype(np.float64))

    ranges = [
        Channel.logged(series(name, "m", rows.tof_m[:, i]), Role.READING, no_target=no_target[:, i], stale=stale[:, i])
        for name, i in RANGES.items()
        if ("d_f", "d_l", "d_r")[i] in rows.columns
    ]
    others = [
        ("x_m", "x", rows.pose[:, 0], Role.READING),
        ("y_m", "y", rows.pose[:, 1], Role.READING),
        ("theta_rad", "theta", np.unwrap(rows.pose[:, 2]), Role.READING),
        ("v_m_s", "v", rows.twist[:, 0], Role.READING),
        ("w_rad_s", "w", rows.twist[:, 1], Role.READING),
        ("state", "state", rows.state, Role.INPUT),
        *((f"line_{i}", f"L{i}", rows.line[:, i], Role.READING) for i in range(8)),
    ]
    measured = [
        Channel.logged(series(name, units[column].replace("-", ""), values), role)
        for name, column, values, role in others
        if column in rows.columns
    ]
    return (*ranges, *measured)


def trial_of(name: str, rows: Rows, channels: Sequence[Channel]) -> Trial:
    return Trial(name, 1e-3 * rows.t_ms, np.zeros(len(rows.t_ms), dtype=bool), tuple(channels))


def no_target_code_m(tof_m: Array) -> float | None:
    """Return the largest of all ranges if it is frequent, large, and no other range is close to it."""
    if not np.isfinite(tof_m).any():
        return None
    largest = float(np.nanmax(tof_m))
    others = tof_m[tof_m < largest]
    is_detached = not len(others) or largest - others.max() >= MIN_GAP_M
    is_code = is_detached and largest >= MIN_CODE_M and np.count_nonzero(tof_m == largest) >= MIN_COUNT
    return largest if is_code else None


def _read(path: Path) -> Measurement:
    rows = read_rows(path.resolve())  # the user has named it, and it may be a link
    code_m = no_target_code_m(rows.tof_m)
    code = np.zeros(rows.tof_m.shape, dtype=bool) if code_m is None else rows.tof_m == code_m
    note = "no reading is taken for no target"
    if code_m is not None:
        note = f"the largest range, {code_m:g} m, comes {np.count_nonzero(code)} times and is taken for no target"
    trial = trial_of("1", rows, row_channels(rows, code, np.zeros_like(code)))
    notes = ("not logged: voltages, encoder counts", note, "nothing is marked as held out")
    return Measurement(
        path.stem, CaseKind.DRIVE_LOG, MeasurementSource("a SyMoLo data.csv", (str(path),)), (trial,), notes=notes
    )


def _recognises(path: Path) -> bool:
    names = first_line(path).split(",")
    return names[: len(HEADER)] == list(HEADER) or (path.name == DATA and {*REQUIRED} <= {*names} <= {*HEADER})


IMPORTER = Importer("data-csv", _recognises, _read)

"""Files of estimated poses: lines as of TUM and evo, or a CSV table whose columns name their units."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from symolo.core.arrays import Array
from symolo.core.errors import InputError, together
from symolo.core.files.text_file import TextFile, read_text
from symolo.core.tables.pose_lines import check_times
from symolo.core.tables.table import CsvTable, NumberColumn, cells_of, header_faults, table_of
from symolo.core.tables.tum_file import read_tum
from symolo.evaluation.estimate import COVARIANCE_ALLOWED, EstimatedTrajectory, check_size, first_impossible

ENDINGS = (".csv", ".txt", ".tum")
"""Endings of files of estimates: tables, and lines as of TUM."""
ENTRIES = tuple((i, j) for i in range(3) for j in range(i, 3))
"""Row and column of the covariances in a table: the upper triangle, row by row."""
BASELINE_HEADER = ("t", "x", "y", "theta", "x_x", "x_y", "x_theta", "y_y", "y_theta", "theta_theta")
"""Columns of the estimates that `symolo baselines` writes: those of data.csv in ms, m and rad, and the covariance."""
_MIN_UPRIGHT = 0.8
"""Smallest cosine between the z axis of the body and that of W: a robot stands on the floor."""


def read_estimate(path: str | Path) -> EstimatedTrajectory:
    """Return the poses of a file: a CSV table if its name ends in `.csv`, otherwise lines as of TUM.

    Raises:
        InputError: The file cannot be read, has a fault, or has poses of another body than a robot on the floor.
    """
    path = Path(path)
    return _from_table(path) if path.suffix.lower() == ".csv" else _from_lines(path)


def _from_lines(path: Path) -> EstimatedTrajectory:
    poses = read_tum(path)
    upright = float(np.median(poses.rotation[:, 2, 2]))
    if upright < _MIN_UPRIGHT:
        tilt_deg = np.degrees(np.arccos(upright))
        what = f"the z axis of the body is tilted by {tilt_deg:.0f} deg against that of the world frame"
        cure = "write poses of the robot, x forward and z up, not those of a camera, in the frame of data.csv"
        raise InputError(what, where=str(path), cure=cure)
    yaw = np.arctan2(poses.rotation[:, 1, 0], poses.rotation[:, 0, 0])
    pose = np.column_stack((poses.place_m[:, :2], yaw))
    check_size(poses.t_s, pose, lambda i: f"{path}: row {poses.lines[i]}")
    return EstimatedTrajectory(poses.t_s, pose)


def _from_table(path: Path) -> EstimatedTrajectory:
    text = read_text(path)
    header = tuple(cells_of(text.lines[0]))
    is_baseline = header[:4] == BASELINE_HEADER[:4]
    time, angle = ("t_ms" if "t_ms" in header else "t_s"), ("rad" if "heading_rad" in header else "deg")
    names = BASELINE_HEADER[:4] if is_baseline else (time, "x_m", "y_m", f"heading_{angle}")
    entries = BASELINE_HEADER[4:] if is_baseline else covariance_columns(angle)
    table = _whole(text, header, names, entries)
    t, x, y, heading = (table.numbers[name] for name in names)
    # A row with an empty cell has no estimate.
    is_there = np.isfinite(np.column_stack([*table.numbers.values()])).all(axis=1)
    if not is_there.any():
        raise InputError("has no row without an empty cell", where=str(path), cure="write a row for each estimate")
    per_s = 1.0 if names[0] == "t_s" else 1000.0
    per_rad = 1.0 if is_baseline or angle == "rad" else 180.0 / np.pi
    rows = [int(row) for row in table.row[is_there]]
    t_s = t[is_there] / per_s
    check_times(t_s, rows, path)
    pose = np.column_stack((x, y, heading / per_rad))[is_there]
    check_size(t_s, pose, lambda i: f"{path}: row {rows[i]}")
    covariance = _covariance(table.numbers, entries, per_rad)
    covariance = None if covariance is None else covariance[is_there]
    if covariance is not None and (i := first_impossible(covariance)) is not None:
        raise InputError(
            "no covariance", where=f"{path}: row {rows[i]}", got=covariance[i].tolist(), allowed=COVARIANCE_ALLOWED
        )
    return EstimatedTrajectory(t_s, pose, covariance)


def covariance_columns(angle: str) -> tuple[str, ...]:
    """Return the names of the columns of the covariance, in the order of `ENTRIES`, for headings in `deg` or `rad`."""
    return (
        "var_x_m2",
        "cov_x_y_m2",
        f"cov_x_heading_m_{angle}",
        "var_y_m2",
        f"cov_y_heading_m_{angle}",
        f"var_heading_{angle}2",
    )


def _whole(text: TextFile, header: tuple[str, ...], names: tuple[str, ...], entries: tuple[str, ...]) -> CsvTable:
    """Return the table with the columns `names`, and `entries` as far as they are there."""
    variances = [entries[k] for k, (i, j) in enumerate(ENTRIES) if i == j]
    if any(entry in header for entry in entries):
        names = (*names, *variances)
    faults = header_faults(header, (*names, *(entry for entry in entries if entry not in names)), optional=entries)
    missing = [name for name in names if name in entries and name not in header]
    if missing and not faults:
        cure = "give the variances of x, y and heading, or no column of the covariance"
        raise InputError(f"column {missing[0]} is missing", where=f"{text.path}: row 1", cure=cure)
    if faults:
        raise together([fault.error(text.path) for fault in faults])
    columns = [NumberColumn(name, may_be_empty=True) for name in header]
    table = table_of(text, columns, range(len(header)), first=1)
    if table.faults:
        raise together([fault.error(text.path) for fault in table.faults])
    return table


def _covariance(numbers: Mapping[str, Array], entries: tuple[str, ...], per_rad: float) -> Array | None:
    """Return the covariances (N, 3, 3) in m and rad; entries outside of the diagonal are zero if they are absent."""
    if not any(entry in numbers for entry in entries):
        return None
    covariance = np.zeros((len(next(iter(numbers.values()))), 3, 3))
    for entry, (i, j) in zip(entries, ENTRIES, strict=True):
        if entry in numbers:
            value = numbers[entry] / per_rad ** ((i == 2) + (j == 2))
            covariance[:, i, j] = covariance[:, j, i] = value
    return covariance

"""The rows of a run at the images of a camera whose rate is not that of data.csv."""

import numpy as np

from symolo.core.errors import InputError
from symolo.core.geometry.robot_path import RobotPath
from symolo.dataset.rates import RowAndImageRates, period_beside_rows_s
from symolo.dataset.tables.rows import COLUMNS, HEADER, Ints, Rows, heading

MAX_PER_ROW = 10_000
"""Largest number of images between two rows: those of 1 kHz between rows every 10 s."""
_DECIMALS = {name: COLUMNS[HEADER.index(name)].decimals for name in ("x", "y", "theta", "v", "w")}


def path_of(rows: Rows) -> RobotPath:
    """Return the path of the robot through the rows of data.csv."""
    return RobotPath(rows.t_ms / 1000, rows.pose, rows.twist)


def image_times_ms(t_ms: Ints, period_s: float) -> Ints:
    """Return the times (images,) in whole milliseconds, from the first row to the last of the rows at t_ms (N,).

    Raises:
        InputError: The times would not fit into memory, because those of the rows are damaged.
    """
    periods = int((t_ms[-1] - t_ms[0]) / (1000 * period_s) + 1e-9)
    if periods > MAX_PER_ROW * len(t_ms):
        what = f"column t ends at {t_ms[-1]} ms after {len(t_ms)} rows, with an image every {1000 * period_s:g} ms"
        raise InputError(what, cure="run `symolo verify` on the dataset")
    periods = np.arange(periods + 1)
    return t_ms[0] + np.rint(1000 * period_s * periods).astype(np.int64)


def rows_at_images(rows: Rows, period_s: float) -> Rows:
    """Return a row for each image of a camera, from the start of the run on; times are in whole milliseconds.

    Pose and speeds are those of the path at the time of the image, rounded to the digits of data.csv. Everything else
    is that of the last row before it. Images are numbered from 1.
    """
    return rows_at(rows, image_times_ms(rows.t_ms, period_s))


def rows_at(rows: Rows, t_ms: Ints) -> Rows:
    """Return a row for each image of a camera at these times (N,) [ms], as `rows_at_images` does."""
    before = np.searchsorted(rows.t_ms, t_ms, side="right") - 1
    pose = path_of(rows).poses_at(t_ms / 1000)
    pose[:, 2] = heading(pose[:, 2], _DECIMALS["theta"])
    pose[:, :2] = np.round(pose[:, :2], _DECIMALS["x"]) + 0.0
    v, w = (np.round(np.interp(t_ms, rows.t_ms, speed), _DECIMALS["v"]) + 0.0 for speed in rows.twist.T)
    return Rows(
        t_ms=t_ms,
        pose=pose,
        state=rows.state[before],
        twist=np.stack([v, w], axis=1),
        tof_m=rows.tof_m[before],
        line=rows.line[before],
        image=np.arange(1, len(t_ms) + 1),
    )


def main_camera_rows(rows: Rows, rates: RowAndImageRates | None) -> Rows:
    """Return a row for each image of the camera of data.csv.

    They are those rows of data.csv that have an image, if the rate of the images divides that of the rows; if not,
    those of `rows_at_images`.
    """
    if (period_s := period_beside_rows_s(rates)) is not None:
        return rows_at_images(rows, period_s)
    return rows.where(rows.image > 0)


def image_column(t_ms: Ints, rates: RowAndImageRates) -> Ints:
    """Return the column img of the rows at t_ms (N,) of a simulation: numbers from 1, 0 for none.

    If the rate of the images divides that of the rows, each image is taken at its row. If not, a row has the number of
    the image that is nearest in time among those whose nearest row it is; the earlier one of two equally near. A camera
    with a rate of 0 takes none.
    """
    if not rates.camera_hz:
        return np.zeros(len(t_ms), dtype=np.int64)
    if (period_s := period_beside_rows_s(rates)) is None:
        rows = np.arange(len(t_ms))
        per_image = round(rates.control_hz / rates.camera_hz)
        return np.where(rows % per_image == 0, 1 + rows // per_image, 0)
    at_ms = image_times_ms(t_ms, period_s)
    row = np.searchsorted((t_ms[1:] + t_ms[:-1]) / 2, at_ms)
    order = np.lexsort((np.abs(at_ms - t_ms[row]), row))
    nearest = order[np.concatenate(([True], np.diff(row[order]) > 0))]
    column = np.zeros(len(t_ms), dtype=np.int64)
    column[row[nearest]] = nearest + 1
    return column

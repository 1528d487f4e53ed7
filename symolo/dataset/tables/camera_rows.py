"""The rows of a run at the images of a further camera, which has a rate of its own."""

import numpy as np
from numpy.typing import NDArray

from symolo.core.geometry.robot_path import RobotPath
from symolo.dataset.tables.rows import COLUMNS, HEADER, Rows, heading

_DECIMALS = {name: COLUMNS[HEADER.index(name)].decimals for name in ("x", "y", "theta", "v", "w")}


def path_of(rows: Rows) -> RobotPath:
    """Return the path of the robot through the rows of data.csv."""
    return RobotPath(rows.t_ms / 1000, rows.pose, rows.twist)


def rows_at_images(rows: Rows, period_s: float) -> Rows:
    """Return a row for each image of a camera, from the start of the run on; times are in whole milliseconds.

    Pose and speeds are those of the path at the time of the image, rounded to the digits of data.csv. Everything else
    is that of the last row before it. Images are numbered from 1.
    """
    duration_ms = rows.t_ms[-1] - rows.t_ms[0]
    periods = np.arange(int(duration_ms / (1000 * period_s) + 1e-9) + 1)
    return rows_at(rows, rows.t_ms[0] + np.rint(1000 * period_s * periods).astype(np.int64))


def rows_at(rows: Rows, t_ms: NDArray[np.int64]) -> Rows:
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

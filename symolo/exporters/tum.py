"""Trajectories in the format of the TUM RGB-D benchmark, which evo and other tools read.

Each pose is a line `timestamp tx ty tz qx qy qz qw`, with times in s, lengths in m, and the scalar qw last
(https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats).
"""

from collections.abc import Iterator

import numpy as np

from symolo.core.arrays import Array
from symolo.core.geometry.poses import pose_X_WR, quaternions
from symolo.dataset.tables.rows import csv_bytes
from symolo.dataset.tables.side_tables import WHEELS
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run

_HEADER = ("# timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw")
_DECIMALS = (3, 6, 6, 6, 9, 9, 9, 9)
_ODOMETRY = ["odometry_x", "odometry_y", "odometry_theta"]


def _files(data: Dataset, _settings: ExportSettings) -> Iterator[ExportedFile]:
    for run in data.runs:
        known = [("robot", _robot), *([("camera", _camera)] if run.numbers else [])]
        known += [("odometry", _odometry)] if WHEELS.name in run.side_names else []
        for name, poses in known:
            yield ExportedFile(f"{run.name}/{name}.txt", lambda run=run, poses=poses: _text(*poses(run)))


def _robot(run: Run) -> tuple[Array, Array]:
    return run.t_s, np.array([pose_X_WR(*pose) for pose in run.table.pose.tolist()])


def _camera(run: Run) -> tuple[Array, Array]:
    return np.array([image.t_s for image in run.images]), run.X_WC


def _odometry(run: Run) -> tuple[Array, Array]:
    """Return the odometry with the true start pose; side/wheels.csv begins at (0, 0, 0)."""
    X_WS = pose_X_WR(*run.table.pose[0].tolist())
    poses = run.side("wheels")[_ODOMETRY].to_numpy().tolist()
    return run.t_s, np.array([X_WS @ pose_X_WR(*pose) for pose in poses])


def _text(t_s: Array, X: Array) -> bytes:
    """Return the file of poses (N, 4, 4) at times (N,)."""
    rotations = quaternions(X[:, :3, :3])
    # A rotation has two quaternions, q and -q. We write the one that is closer to the previous line, so that
    # a reader can interpolate between lines.
    signs = np.where(np.sum(rotations[1:] * rotations[:-1], axis=1) < 0, -1.0, 1.0)
    rotations[1:] *= np.cumprod(signs)[:, None]
    return csv_bytes(_HEADER, _DECIMALS, np.column_stack((t_s, X[:, :3, 3], rotations)), separator=" ")


EXPORTER = Exporter("tum", "poses of robot, camera and odometry of each run, as evo reads them", _files)
